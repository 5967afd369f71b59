"""Distinguishing motions: in which kind of motion explanations differ, computed from the formulas of their effects.

This is the one answer for a discovery, a comparison of logs, a designed motion and the monitor. It needs nothing but
the effects themselves, so it holds for a user's own effect too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect, State
from cdia_pin.identifiability.structural_rank import REACH, are_alike, random_states
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Draw = tuple[Array, Array, Array, Array]  # q, v, a of shape (K, n) and time of shape (K,)

SAMPLES = 60  # states [1] of each kind of motion, several times the parameters of any pair of effects
SLOW, FAST = 0.05, 1.5  # [rad/s or m/s], where Coulomb friction dominates, and where viscous friction does
QUICK = 5.0  # [rad/s² or m/s²], standard deviation at a reversal
NEAR = 0.02  # [rad or m] around one posture
NEGLIGIBLE = 1e-9  # norm of a column beside the largest, or share of it that others leave, that is rounding
ENOUGH = 0.5  # share of the largest separation at which a simpler motion is preferred
NO_MOTION = "no motion of this arm does"  # how the answer begins where nothing can be driven
WEIGHTLESS = 1e-9  # share of the largest joint's gravity torque below which gravity does not load a joint


@dataclass(frozen=True)
class MotionKind:
    """A kind of motion that a person can drive.

    Attributes:
        words: How to drive it.
        draw: States along it, from a robot, which joints the explanations name, shape (n,), and a generator.
    """

    words: str
    draw: Callable[[RobotModel, NDArray[np.bool_], np.random.Generator], Draw]


def distinguishing_motion(explanations: Sequence[Sequence[Effect]], robot: RobotModel) -> str:
    """Return in words the simplest motion in which explanations clearly differ.

    Whichever of two explanations is true must show what the other cannot imitate. The share of its columns that is left
    is compared with the largest share on any motion. A pair in which one always imitates the other does not count.

    Args:
        explanations: Each the effects that explain together.
        robot: The arm.
    """
    named = tuple(dict.fromkeys(j for effects in explanations for e in effects for j in e.scope))
    motions = [_states(robot, kind, named) for kind in range(len(KINDS))]
    bases = [[_basis(effects, x) for effects in explanations] for x in motions]
    pairs = list(permutations(range(len(explanations)), 2))
    shares = np.array(
        [[_left(b[true], b[fitted]) for true, fitted in pairs] for b in bases]
    )  # (kinds, pairs)
    most = shares.max(axis=0, initial=0.0)
    separable = most > NEGLIGIBLE
    if not separable.any():
        return KINDS[-1].words
    scores = (shares[:, separable] / most[separable]).min(axis=1)
    return next(k.words for k, score in zip(KINDS, scores, strict=True) if score >= ENOUGH * scores.max())


def motion_between(one: Effect, other: Effect, robot: RobotModel) -> str:
    """Return in words a motion in which two effects differ, or why there is none.

    Args:
        one: One effect.
        other: The other.
        robot: The arm.
    """
    if are_alike(robot, one, other):
        return f"{NO_MOTION}: {why_alike([one], [other], robot)}"
    return _motion_between(one, other, robot)


def prepare(robot: RobotModel, joint: str) -> None:
    """Compute the motions for explanations on one joint beforehand, so that a control loop need not wait for them.

    Args:
        robot: The arm.
        joint: Name of the joint.
    """
    for kind in range(len(KINDS)):
        _states(robot, kind, (joint,))


def why_alike(one: Sequence[Effect], other: Sequence[Effect], robot: RobotModel) -> str:
    """Return in words why two explanations do not differ on any motion.

    Args:
        one: One explanation.
        other: The other.
        robot: The arm.
    """
    bodies = [body for e in (*one, *other) for body in e.bodies]
    if len(bodies) == 2 and bodies[0].carrier(robot) == bodies[1].carrier(robot):
        return "both are a body on the same link: repeat a log with the tool taken off"
    first, second = (" + ".join(e.label for e in effects) for effects in (one, other))
    return f"whatever {first} does, {second} can do as well{weightless_remark(one, robot)}"


def weightless_remark(effects: Sequence[Effect], robot: RobotModel) -> str:
    """Return the remark that gravity does not load a joint that effects name; empty where it loads all.

    Args:
        effects: The effects.
        robot: The arm.
    """
    load = np.abs(robot.gravity(random_states(robot).q)).max(axis=0)
    joints = dict.fromkeys(j for e in effects for j in e.scope)
    weightless = [j for j in joints if load[robot.joint_index(j)] <= WEIGHTLESS * load.max()]
    if not weightless:
        return ""
    return f" (gravity does not load {', '.join(weightless)}, whose axis is along it)"


# ------------------------------------------------------------- kinds of motion


def _anywhere(robot: RobotModel, rng: np.random.Generator, count: int = SAMPLES) -> Array:
    lower, upper = np.maximum(robot.limits.lower, -REACH), np.minimum(robot.limits.upper, REACH)
    return rng.uniform(lower, upper, (count, robot.n))


def _both_ways(shape: tuple[int, ...], rng: np.random.Generator) -> Array:
    return rng.choice([-1.0, 1.0], shape)


def _sweep(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    moved = named if named.any() else ~named
    q = np.where(moved, _anywhere(robot, rng), _anywhere(robot, rng, 1))
    v = np.where(moved, SLOW * _both_ways(q.shape, rng), 0.0)
    return q, v, np.zeros_like(q), np.zeros(SAMPLES)


def _poses(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    q = _anywhere(robot, rng)
    return q, SLOW * _both_ways(q.shape, rng), np.zeros_like(q), np.zeros(SAMPLES)


def _speeds(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    q = _anywhere(robot, rng, 1) + NEAR * rng.standard_normal((SAMPLES, robot.n))
    size = np.exp(rng.uniform(np.log(SLOW), np.log(FAST), q.shape))
    return q, size * _both_ways(q.shape, rng), np.zeros_like(q), np.zeros(SAMPLES)


def _reversals(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    q = _anywhere(robot, rng, 1) + NEAR * rng.standard_normal((SAMPLES, robot.n))
    return q, SLOW * _both_ways(q.shape, rng), QUICK * rng.standard_normal(q.shape), np.zeros(SAMPLES)


def _everything(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    q = _anywhere(robot, rng)
    v, a = FAST * rng.standard_normal(q.shape), QUICK * rng.standard_normal(q.shape)
    return q, v, a, np.arange(SAMPLES, dtype=float)


# The simplest to drive comes first.
KINDS = (
    MotionKind("sweep the joint slowly over its whole range, both ways", _sweep),
    MotionKind("hold the arm in poses with gravity on and off the joint, at rest and moving slowly", _poses),
    MotionKind("move the joint at several constant speeds, both ways, up to its fastest", _speeds),
    MotionKind("reverse quickly at small amplitude, then move at constant speed", _reversals),
    MotionKind(
        "turn the links through all orientations, at two reaches of the arm, slowly and fast", _everything
    ),
)


@lru_cache(maxsize=256)
def _states(robot: RobotModel, kind: int, named: tuple[str, ...]) -> State:
    """Return states along a kind of motion, always the same for one robot and the same joints."""
    joints = np.isin(np.array(robot.joints), named)
    q, v, a, time = KINDS[kind].draw(robot, joints, np.random.default_rng(0))
    return State(robot, q, v, a, robot.inverse_dynamics(q, v, a), time)


@lru_cache(maxsize=4096)
def _motion_between(one: Effect, other: Effect, robot: RobotModel) -> str:
    return distinguishing_motion([[one], [other]], robot)


def _basis(effects: Sequence[Effect], x: State) -> Array:
    """Return an orthonormal basis of what effects can do on a motion, shape (K n, r)."""
    columns = np.column_stack([np.zeros((x.q.size, 0)), *(e.basis(x).reshape(x.q.size, -1) for e in effects)])
    norm = np.linalg.norm(columns, axis=0)
    seen = norm > NEGLIGIBLE * norm.max(initial=0.0)
    if not seen.any():
        return columns[:, :0]
    left, values, _ = np.linalg.svd(columns[:, seen] / norm[seen], full_matrices=False)
    return np.asarray(left[:, values > NEGLIGIBLE * values[0]])


def _left(basis: Array, by: Array) -> float:
    """Return the largest share of a direction in one basis that is outside the other [1]."""
    if not basis.shape[1]:
        return 0.0
    outside = basis - by @ (by.T @ basis)
    return float(np.linalg.svd(outside, compute_uv=False)[0] ** 2)
