"""The full identification: from a model and logs to the parameters of all links, friction and rotors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import LogError
from cdia_pin.identification.base import base_parameters
from cdia_pin.identification.block_validation import choose_strength, held_out_rms
from cdia_pin.identification.estimate import Fitter
from cdia_pin.identification.identification_result import Identification
from cdia_pin.identification.identification_settings import IdentificationSettings
from cdia_pin.identification.intervals import of_bodies, quantile, uncertainty, with_intervals
from cdia_pin.identification.refinement import fitted_without_idle_drives, refine
from cdia_pin.identification.terms import full_model
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.log import Log, listed
from cdia_pin.logs.motion import Motion
from cdia_pin.progress import Progress, part, silent
from cdia_pin.regression.effort_scale import stated_tolerance
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.threads import on_one_thread
from cdia_pin.version import __version__

LEAST_TORQUE = 1e-9  # [1], largest torque over the largest error of the model; below it none was recorded
FIRST_STRENGTH = 10.0  # strength of the prior [1] while the friction laws are found, before it is chosen


@on_one_thread
def identify(
    model: Dynamics,
    logs: Log | Sequence[Log],
    *,
    holdout: Log | Sequence[Log] | None = None,
    settings: IdentificationSettings | None = None,
    progress: Progress | None = None,
    start: Dynamics | None = None,
    keep: Callable[[Dynamics], None] | None = None,
) -> Identification:
    r"""Fit the inertial parameters of all links, and friction, offset and rotor of all joints, to measured logs.

    It minimises the weighted squared error :math:`\sum_j \|e_j\|^2 / \sigma_j^2` plus the distance of the links from
    the URDF's [Lee2020], over the parameters of bodies that can exist [Wensing2018]. The strength of this prior is
    chosen by cross-validation over blocks of time; a motion that shows little of a link leaves it as in the URDF. It
    does not decide which effect is real: a tool is spread over the links that carry it. For that, see `discover`.

    Args:
        model: The model as it is known: a bare robot, or one with terms. The terms are fitted again with all else.
        logs: One log or several of the same arm in the same condition.
        holdout: Logs that are only predicted; without them, each block of time is predicted from the others.
        settings: How logs are filtered, and what may be fitted.
        progress: Called with a sentence and the share done, from 0 to 1.
        start: Model of the same arm that an interrupted identification gave to ``keep``; it goes on from there.
        keep: Called with each better model, so that an interrupted identification is not lost.

    Returns:
        The identified model, which remembers the logs, its errors, and base parameters.

    Raises:
        LogError: If a log is too short or of other joints.
    """
    report = progress or silent
    settings = settings or IdentificationSettings()
    given, unseen = listed(logs), listed(holdout)
    report("conditioning", 0.0)
    experiment, held_out = (
        Experiment.of(model.robot, [condition(log, model.robot, settings.conditioning) for log in side])
        if side
        else None
        for side in (given, unseen)
    )
    assert experiment is not None
    torque, expected = np.abs(experiment.measured).max(), np.abs(experiment.predict(model).residual).max()
    if torque <= LEAST_TORQUE * expected:
        raise LogError(f"{given[0].source}: the torque is {torque:.3g} N·m at most: it was not recorded")
    fitter = Fitter(experiment, settings)
    report("fitting links, friction and rotors", 0.1)
    whole = full_model(model, experiment, settings)
    plain, keep = {t.label for t in whole.terms}, keep or _forgotten
    begin = whole if start is None else Dynamics(model.robot, start.terms)
    estimate = fitter.fit(begin, settings.strength or FIRST_STRENGTH)
    keep(estimate.model)
    if settings.refine:
        report("refining friction", 0.2)
        estimate = refine(fitter, estimate, part(report, 0.2, 0.7), keep)
    report("choosing the strength of the prior", 0.7)
    strength = choose_strength(fitter, estimate) if settings.strength is None else settings.strength
    estimate = fitted_without_idle_drives(fitter, estimate.model, strength)
    report("predicting held-out data", 0.9)
    known = uncertainty(experiment, estimate)
    bodies, tolerance = of_bodies(estimate), stated_tolerance(experiment)
    predicted = held_out or experiment
    after = (
        held_out_rms(fitter, estimate)
        if held_out is None
        else rms(held_out.predict(estimate.model).residual, held_out.informative)
    )
    report("done", 1.0)
    return Identification(
        model=replace(
            with_intervals(estimate, known.after, tolerance),
            learned_from=_remembered(given, experiment, settings),
        ),
        torque_rms=rms(experiment.measured, experiment.informative),
        rms_before=rms(experiment.predict(model).residual, experiment.informative),
        rms_after=rms(experiment.predict(estimate.model).residual, experiment.informative),
        heldout_torque_rms=rms(predicted.measured, predicted.informative),
        heldout_before=rms(predicted.predict(model).residual, predicted.informative),
        heldout_after=after,
        base=base_parameters(
            model.robot,
            bodies @ estimate.theta,
            bodies @ known.after @ bodies.T,
            bodies @ known.before @ bodies.T,
            quantile(estimate),
            tolerance,
        ),
        strength=strength,
        refined=tuple(t.label for t in estimate.model.terms if t.label not in plain),
        record={
            "version": __version__,
            "logs": [s.motion.record for s in experiment.segments],
            "holdout": [s.motion.record for s in held_out.segments] if held_out else [],
            "blocks": settings.blocks,
            "strength": settings.strength if settings.strength is not None else "cross-validated",
            "refine": settings.refine,
        },
    )


def _remembered(
    logs: Sequence[Log], experiment: Experiment, settings: IdentificationSettings
) -> tuple[Motion, ...]:
    """Return the logs as a search for effects would see them, so that a later one can be compared with them."""
    conditioning = DiscoverySettings(conditioning=settings.conditioning).searched
    return experiment.remembered([condition(log, experiment.robot, conditioning) for log in logs])


def _forgotten(_: Dynamics) -> None:
    """Keep nothing."""
