"""Candidates: every effect of the vocabulary in every scope, with the shapes worth trying."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import (
    EFFECTS,
    CoulombFriction,
    Drift,
    Effect,
    Expression,
    PerLog,
    PositionRipple,
    RotorInertia,
    Signal,
    TorqueOffset,
    Unknown,
    ViscousFriction,
)
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]

LARGE_FAMILY = 12  # an effect with more shapes than that is screened before it is a candidate
SLOW = (CoulombFriction, ViscousFriction, TorqueOffset)  # what may drift within a log
SCREENED = 2  # shapes that pass the screening


def enumerate_candidates(
    experiment: Experiment, prediction: Prediction, settings: DiscoverySettings
) -> list[list[Effect]]:
    """Return the candidates in families of one effect and scope, each with its shapes.

    Raises:
        EffectError: If the settings name an effect that is not in the vocabulary.
    """
    robot = experiment.robot
    names = settings.effects or tuple(n for n, e in EFFECTS.items() if e not in (Unknown, Expression))
    for name in names:
        if name not in EFFECTS:
            raise EffectError(unknown_name("effect", name, EFFECTS))
    x = experiment.along(prediction)
    rigid = np.vstack([s.motion.compared(s.state.rigid_torque) for s in experiment.segments])
    rigid_share = rms(rigid, experiment.informative) / np.maximum(
        rms(experiment.measured, experiment.informative), 1e-12
    )
    families: list[list[Effect]] = []
    for name in names:
        if EFFECTS[name] is Expression:
            continue
        for scope in EFFECTS[name].scopes(robot):
            effect = EFFECTS[name].from_scope(scope, {})
            if _can_be_seen(effect, experiment, rigid_share >= settings.criterion.least_rigid_share):
                families.append(list(effect.shape_grid(x)))
    for effect in settings.extra:
        families.extend([e] for e in _expanded(effect, experiment))
    return [per_log(f, experiment, settings.per_log) for f in families if f]


def per_log(family: list[Effect], experiment: Experiment, asked: Sequence[str]) -> list[Effect]:
    """Return a family with parameters per log, if its effect, by name or label, is among those asked for."""
    if not {family[0].name, family[0].label} & set(asked):
        return family
    return [PerLog(e, experiment.logs) for e in family]


def drifting(effects: Iterable[Effect], experiment: Experiment) -> list[list[Effect]]:
    """Return the families of friction and offsets, on the joints of some effects, that drift within the log.

    Only effects of one parameter: more of them, each with a beginning and an end, would fit whatever is left. None
    where there are several logs.
    """
    if len(experiment.segments) > 1:
        return []
    time = experiment.segments[0].motion.time
    start, end = float(time[0]), float(time[-1])
    joints = dict.fromkeys(
        j for e in effects if e.traits.dissipative or isinstance(e, TorqueOffset) for j in e.scope
    )
    slow = [Drift(kind(j), start, end, end - start) for j in joints for kind in SLOW]
    return [list(e.shape_grid(experiment.segments[0].state)) for e in slow]


def _expanded(effect: Effect, experiment: Experiment) -> Iterator[Effect]:
    if isinstance(effect, Expression):
        yield from effect.expand(experiment.robot)
    else:
        yield effect


def _can_be_seen(effect: Effect, experiment: Experiment, loaded: NDArray[np.bool_]) -> bool:
    """Tell whether an effect can show on this motion.

    Effects of motion need a joint that moves; those of the torque one that carries something, for where all torque is
    friction, a gain is only another name for it.
    """
    joints = [experiment.robot.joint_index(j) for j in effect.scope]
    if Signal.TORQUE in effect.traits.depends_on and joints and not loaded[joints].all():
        return False
    moves = effect.traits.dissipative or isinstance(effect, RotorInertia | PositionRipple)
    return not (moves and experiment.resting[joints].any())


def screen(
    families: Iterable[list[Effect]],
    design: DesignMatrix,
    prediction: Prediction,
    noise: Sequence[NoiseModel],
    leftover: Array,
) -> list[Effect]:
    """Keep of each large family the shapes that fit what is left best, and all of the small ones.

    Args:
        families: From `enumerate_candidates`.
        design: Columns of effects.
        prediction: Of the present model.
        noise: Noise of each joint.
        leftover: Whitened residual of the present model, uninformative samples zero, shape (K, n).
    """
    out: list[Effect] = []
    for family in families:
        if len(family) <= LARGE_FAMILY:
            out.extend(family)
            continue
        (j,) = family[0].acts_on(design.experiment.robot)
        white, inverse = design.family(family, prediction, noise[j])
        right = white @ leftover[:, j]
        best = np.argsort(np.einsum("cp,cpq,cq->c", right, inverse, right))[::-1]
        chosen: list[int] = []
        for c in best:  # neighbours of the best are the same ripple again
            if all(abs(int(c) - other) > 2 for other in chosen):
                chosen.append(int(c))
            if len(chosen) == SCREENED:
                break
        out.extend(family[c] for c in chosen)
    return out
