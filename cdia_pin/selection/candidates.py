"""Candidates: every effect of the vocabulary in every scope, each with the shapes of its grid."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import (
    EFFECTS,
    AsymmetricFriction,
    CoulombFriction,
    Drift,
    Effect,
    Expression,
    JointEffect,
    PerLog,
    PositionRipple,
    RotorInertia,
    Signal,
    TorqueOffset,
    ViscousFriction,
)
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]

# Shapes [1]; an effect with more is screened, because each candidate adds to the normal equations.
LARGE_FAMILY = 12
SLOW = (CoulombFriction, ViscousFriction, TorqueOffset)  # effects that may drift within a log
SCREENED = 2  # shapes of a large family [1] that pass the screening
NEIGHBOURS = 2  # steps of the grid [1] within which shapes are nearly the same effect


def enumerate_candidates(
    experiment: Experiment, prediction: Prediction, settings: DiscoverySettings
) -> list[list[Effect]]:
    """Return the candidates in families: each family is one effect and scope in its shapes.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of the present model, for the load.
        settings: The effects that may be found, and the least load for effects of the torque.

    Raises:
        EffectError: If the settings name an effect that is not in the vocabulary.
    """
    robot = experiment.robot
    names = settings.effects or tuple(n for n, e in EFFECTS.items() if e.plausibility.searched)
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
            if settings.effects is None and not experiment.sees(effect):
                break
            if _can_be_seen(effect, experiment, rigid_share >= settings.criterion.least_rigid_share):
                families.append(list(effect.shape_grid(x)))
    for effect in settings.extra:
        families.extend([e] for e in _expanded(effect, experiment))
    return [per_log(f, experiment, settings.per_log) for f in families if f]


def per_log(family: list[Effect], experiment: Experiment, asked: Sequence[str]) -> list[Effect]:
    """Return a family with parameters per log if they are asked for, otherwise the family itself.

    Args:
        family: One effect and scope in its shapes.
        experiment: The conditioned logs.
        asked: Names or labels of the effects that get parameters per log.
    """
    if not {family[0].name, family[0].label} & set(asked):
        return family
    return [PerLog(e, experiment.logs) for e in family]


def drifting(effects: Iterable[Effect], experiment: Experiment) -> list[list[Effect]]:
    """Return families of friction and offsets that drift within the log, on the joints of some effects.

    Only effects of one parameter may drift: more parameters, each with a start and an end, would fit any residual.
    There are none if there are several logs.

    Args:
        effects: Effects of the present model.
        experiment: The conditioned logs.
    """
    if len(experiment.segments) > 1:
        return []
    time = experiment.segments[0].motion.time
    start, end = float(time[0]), float(time[-1])
    joints = dict.fromkeys(
        j for e in effects if e.traits.dissipative or isinstance(e, TorqueOffset) for j in e.scope
    )
    kinds = [kind(j) for j in joints for kind in SLOW]
    slow = [Drift(e, start, end, end - start) for e in kinds if experiment.sees(e)]
    return [list(e.shape_grid(experiment.segments[0].state)) for e in slow]


def _expanded(effect: Effect, experiment: Experiment) -> Iterator[Effect]:
    if isinstance(effect, Expression):
        yield from effect.expand(experiment.robot)
    else:
        yield effect


def _can_be_seen(effect: Effect, experiment: Experiment, loaded: NDArray[np.bool_]) -> bool:
    """Return True if an effect can show on this motion.

    Nothing shows in the torque of joints that are held. Effects of the motion need a joint that moves, friction that
    differs by direction one that moves both ways, and effects of its position one that leaves its place. Effects of the
    torque need a joint that carries a load: where all torque is friction, a gain only scales it.
    """
    joints = [experiment.robot.joint_index(j) for j in effect.scope]
    if experiment.held[list(effect.acts_on(experiment.robot))].all():
        return False
    if Signal.TORQUE in effect.traits.depends_on and joints and not loaded[joints].all():
        return False
    if isinstance(effect, AsymmetricFriction) and experiment.one_way[joints].any():
        return False
    moves = (
        effect.traits.dissipative
        or bool(effect.memories)
        or isinstance(effect, RotorInertia | PositionRipple)
    )
    leaves = isinstance(effect, JointEffect) and Signal.POSITION in effect.traits.depends_on
    return not (
        (moves and experiment.resting[joints].any()) or (leaves and experiment.in_place[joints].any())
    )


def screen(
    families: Iterable[list[Effect]],
    design: DesignMatrix,
    prediction: Prediction,
    noise: Sequence[NoiseModel],
    leftover: Array,
) -> list[Effect]:
    """Return the candidates: of each large family on one joint the shapes that fit best, and all others.

    Args:
        families: Families of `enumerate_candidates`.
        design: Columns of effects.
        prediction: Prediction of the present model.
        noise: Noise of each joint.
        leftover: Whitened residual of the present model [1], zero for samples that do not count, shape (K, n).
    """
    out: list[Effect] = []
    for family in families:
        joints = family[0].acts_on(design.experiment.robot)
        if len(family) <= LARGE_FAMILY or len(joints) > 1:
            out.extend(family)
            continue
        (j,) = joints
        white, inverse = design.family(family, prediction, noise[j])
        right = white @ leftover[:, j]
        out.extend(family[c] for c in best_shapes(np.einsum("cp,cpq,cq->c", right, inverse, right)))
    return out


def best_shapes(gains: Array) -> list[int]:
    """Return the indices of the shapes of a large family that pass the screening: the best, but no neighbours.

    Args:
        gains: What each shape explains, in the order of the grid [1], shape (C,).
    """
    chosen: list[int] = []
    for c in np.argsort(gains)[::-1].tolist():
        if all(abs(c - other) > NEIGHBOURS for other in chosen):
            chosen.append(c)
        if len(chosen) == SCREENED:
            break
    return chosen
