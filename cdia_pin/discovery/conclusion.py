"""The conclusion of a discovery: trace, verdict and record of the model that was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.phenomenon import Phenomenon
from cdia_pin.discovery.capability import capability_of
from cdia_pin.discovery.discovery_documents import DiscoveryRecord
from cdia_pin.discovery.discovery_result import Discovery, Ranked, Step
from cdia_pin.discovery.ranking import taken_first
from cdia_pin.discovery.recognition import recognised
from cdia_pin.discovery.total_intervals import with_total_intervals
from cdia_pin.discovery.trace import trace
from cdia_pin.discovery.trust import trust_in
from cdia_pin.discovery.verdict import stands_out, verdict_on
from cdia_pin.dynamics import Dynamics
from cdia_pin.identifiability.alternatives import FEW_REFITS, Alternatives
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.rival_names import has_another_name
from cdia_pin.progress import Progress
from cdia_pin.regression.experiment import rms
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.problem import Problem, WhitenedProblem
from cdia_pin.selection.replacement import refitting
from cdia_pin.version import __version__


def concluded(
    problem: WhitenedProblem,
    base: Dynamics,
    found: Dynamics,
    report: Progress,
    *,
    ranking: tuple[Ranked, ...] = (),
    forced: tuple[str, ...] = (),
    findings: tuple[Phenomenon, ...] = (),
) -> Discovery:
    """Return the result of a discovery.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
        report: Called with a sentence and the share done, from 0 to 1.
        ranking: What each candidate would explain alone.
        forced: Labels of effects that stay in any case.
        findings: Phenomena that are already known.
    """
    final, steps = trace(problem, base, found, forced)
    report("repeating the decisions", 0.9)
    trust = trust_in(problem.problem, final, base)
    rivals = _rivals(problem, final)
    final = with_total_intervals(final, trust)

    def repeated(step: Step) -> Step:
        if step.term is None:
            return step
        term = final.find(step.term.label)  # without a parameter that is surely not zero, a name says nothing
        confidence = Confidence.DESCRIPTIVE if term.may_be_nothing else trust[term.label].confidence
        confusions = rivals(term.label, confidence)
        if confidence is Confidence.ESTABLISHED and has_another_name(term, confusions, final.robot):
            confidence = Confidence.LIKELY
        return replace(step, term=term, confidence=confidence, confusions=confusions)

    steps = tuple(map(repeated, steps))
    return conclusion(
        problem.problem, final, steps, report, ranking=taken_first(ranking, steps), findings=findings
    )


def _rivals(problem: WhitenedProblem, final: Dynamics) -> Callable[[str, Confidence], tuple[Confusion, ...]]:
    """Return a function that tells what else could explain what an effect does, by its label and confidence.

    A descriptive effect may be anything, so fewer of its rivals are fitted at their own optimum. The fits take longer
    than all the rest of a conclusion.
    """
    beside = problem.evidence(final)
    present = {t.effect for t in final.terms}
    index = {e.label: i for i, e in enumerate(beside.effects) if e in present}
    closely = Alternatives(
        beside, list(index.values()), refitting(problem, final, beside), problem.settings.alternatives
    )
    roughly = replace(closely, most_refits=FEW_REFITS)

    def rivals(label: str, confidence: Confidence) -> tuple[Confusion, ...]:
        return (roughly if confidence is Confidence.DESCRIPTIVE else closely).of(index[label])

    return rivals


def conclusion(
    logs: Problem,
    final: Dynamics,
    steps: tuple[Step, ...],
    report: Progress,
    *,
    ranking: tuple[Ranked, ...] = (),
    findings: tuple[Phenomenon, ...] = (),
) -> Discovery:
    """Return the result of a discovery whose steps are known.

    Args:
        logs: Logs and settings.
        final: The improved model.
        steps: The model as given, and every effect that was added.
        report: Called with a sentence and the share done, from 0 to 1.
        ranking: What each candidate would explain alone.
        findings: Phenomena that are already known.
    """
    experiment, settings = logs.experiment, logs.settings
    misfit = logs.lack_of_fit(final)
    torque = rms(experiment.measured, experiment.informative)
    unseen = logs.held_out
    unseen_torque = torque if unseen is None else rms(unseen.measured, unseen.informative)
    able = capability_of(experiment, steps[-1].heldout_rms, unseen_torque, settings.changes)
    report("done", 1.0)
    floor, resolution, residual = (
        x / np.maximum(torque, 1e-12) for x in (misfit.floor, experiment.resolution, logs.rms(final))
    )
    structure = misfit.left | stands_out(residual, np.maximum(floor, resolution), settings.practice)
    # static friction carries an unknown part of the load of the other joints
    structure &= experiment.joints_that_move
    left = _where(structure, final.robot)
    return Discovery(
        model=replace(final, learned_from=experiment.remembered()),
        verdict=verdict_on(
            structure.tolist(), able.feedforward_error, floor, len(steps) - 1, settings.practice
        ),
        trace=steps,
        noise_floor=misfit.floor,
        structure_left=left,
        torque_rms=torque,
        heldout_torque_rms=unseen_torque,
        compared_share=experiment.informative.mean(axis=0),
        capability=able,
        held=_where(experiment.held, final.robot),
        resting=_where(experiment.resting & ~experiment.held, final.robot),
        ranking=ranking,
        record=_record(logs),
        findings=(
            *findings,
            *recognised(logs.with_noise_of(misfit).regression, final, left, settings.memory),
        ),
    )


def _where(true: NDArray[np.bool_], robot: RobotModel) -> tuple[str, ...]:
    """Return the names of the joints for which something is true, shape (n,)."""
    return tuple(j for j, t in zip(robot.joints, true, strict=True) if t)


def _record(logs: Problem) -> DiscoveryRecord:
    """Return what a discovery was made from."""
    settings = logs.settings
    return {
        "version": __version__,
        "logs": [s.motion.record for s in logs.experiment.segments],
        "holdout": [s.motion.record for s in logs.held_out.segments] if logs.held_out else [],
        "blocks": settings.blocks,
        "per_log": [*settings.per_log, *logs.differing],
        "most_effects": settings.most_effects,
        **settings.record(),
    }
