"""Candidates: every effect of the vocabulary in every scope, with the shapes worth trying."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.experiment import Experiment, Prediction, rms
from cdia_pin.discovery.settings import DiscoverySettings
from cdia_pin.discovery.whitening import NoiseModel
from cdia_pin.effects import (
    EFFECTS,
    CoulombFriction,
    Drift,
    Effect,
    Expression,
    PerLog,
    PositionRipple,
    RotorInertia,
    TorqueOffset,
    Unknown,
    ViscousFriction,
)
from cdia_pin.errors import EffectError, unknown_name

Array = NDArray[np.float64]

LARGE_FAMILY = 12  # an effect with more shapes than that is screened before it is a candidate
LEAST_RIGID_SHARE = (
    0.2  # of a joint's torque that must be the rigid body's for a gain to be told from friction
)
SLOW = (CoulombFriction, ViscousFriction, TorqueOffset)  # what may drift within a log
SCREENED = 2  # shapes that pass the screening
SAME_GRAVITY = 0.03  # [m/s²], by which gravity may differ and columns of bodies are kept


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
            if _can_be_seen(effect, experiment, rigid_share):
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
        j for e in effects if e.dissipative or isinstance(e, TorqueOffset) for j in e.scope
    )
    slow = [Drift(kind(j), start, end, end - start) for j in joints for kind in SLOW]
    return [list(e.shape_grid(experiment.segments[0].state)) for e in slow]


def _expanded(effect: Effect, experiment: Experiment) -> Iterator[Effect]:
    if isinstance(effect, Expression):
        yield from effect.expand(experiment.robot)
    else:
        yield effect


def _can_be_seen(effect: Effect, experiment: Experiment, rigid_share: Array) -> bool:
    """Tell whether an effect can show on this motion.

    Effects of motion need a joint that moves; those of the torque one that carries something, for where all torque is
    friction, a gain is only another name for it.
    """
    joints = [experiment.robot.joint_index(j) for j in effect.scope]
    if effect.of_torque and joints and (rigid_share[joints] < LEAST_RIGID_SHARE).any():
        return False
    moves = effect.dissipative or isinstance(effect, RotorInertia | PositionRipple)
    return not (moves and experiment.resting[joints].any())


class Columns:
    """Columns of effects in the residual, computed once where they do not depend on the model's torque."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        self._fixed: dict[Effect, Array] = {}
        self._weighed: tuple[Array, dict[Effect, Array]] = (np.zeros(3), {})
        self._families: dict[Effect, tuple[NoiseModel, list[Effect], Array, Array]] = {}

    def of(self, effect: Effect, prediction: Prediction, theta: Array | None = None) -> Array:
        """Return the columns of an effect, shape (K, len(acts_on), p).

        Those of the model's own effects are exact. For a candidate (θ omitted) a gain that changes along the motion
        is replaced by its mean, which is enough to rank it.
        """
        exact = theta is not None
        joints = list(effect.acts_on(self.experiment.robot))
        gain = np.concatenate([t.gain[:, joints] for t in prediction.torques])
        constant = effect.reads or not np.ptp(gain, axis=0).any()
        if effect.of_torque or (exact and not (constant and effect.linear)):
            return self.experiment.columns(effect, prediction, theta)
        fixed = self.fixed(effect, prediction)
        return fixed if effect.reads or (gain == 1.0).all() else fixed / gain.mean(axis=0)[None, :, None]

    def fixed(self, effect: Effect, prediction: Prediction) -> Array:
        """Return the columns of an effect of the motion alone, as in a model without gains."""
        known = self._fixed
        if effect.weighs:
            change = prediction.model.gravity_change
            if np.linalg.norm(change - self._weighed[0]) > SAME_GRAVITY:
                self._weighed = (change, {})
            known = self._weighed[1]
        if effect not in known:
            bare = replace(
                prediction, torques=tuple(replace(t, gain=np.ones_like(t.gain)) for t in prediction.torques)
            )
            known[effect] = self.experiment.columns(effect, bare)
        return known[effect]

    def family(self, family: list[Effect], prediction: Prediction, noise: NoiseModel) -> tuple[Array, Array]:
        """Return a family's whitened columns (C, p, K) of its joint and their inverse Gram matrices (C, p, p)."""
        known = self._families.get(family[0])
        if known is None or known[0] is not noise or known[1] != family:
            (j,) = family[0].acts_on(self.experiment.robot)
            used = self.experiment.informative[:, j]
            stacked = np.stack([self.fixed(e, prediction)[:, 0, :] for e in family], axis=1)  # (K, C, p)
            at = used[:, None, None]
            white = np.where(at, noise.whiten(np.where(at, stacked, 0.0)), 0.0).transpose(1, 2, 0)
            gram = white @ white.transpose(0, 2, 1)
            ridge = 1e-6 * np.einsum("cpp->c", gram)[:, None, None] * np.eye(gram.shape[1])
            known = (noise, family, np.ascontiguousarray(white), np.linalg.inv(gram + ridge))
            self._families[family[0]] = known
        return known[2:]


def screen(
    families: Iterable[list[Effect]],
    columns: Columns,
    prediction: Prediction,
    noise: Sequence[NoiseModel],
    leftover: Array,
) -> list[Effect]:
    """Keep of each large family the shapes that fit what is left best, and all of the small ones.

    Args:
        families: From `enumerate_candidates`.
        columns: Where columns come from.
        prediction: Of the present model.
        noise: Noise of each joint.
        leftover: Whitened residual of the present model, uninformative samples zero, shape (K, n).
    """
    out: list[Effect] = []
    for family in families:
        if len(family) <= LARGE_FAMILY:
            out.extend(family)
            continue
        (j,) = family[0].acts_on(columns.experiment.robot)
        white, inverse = columns.family(family, prediction, noise[j])
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
