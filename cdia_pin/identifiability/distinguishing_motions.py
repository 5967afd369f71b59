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

from cdia_pin.effects import Effect, State, Varying
from cdia_pin.identifiability.structural_rank import are_alike, random_states
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Draw = tuple[Array, Array, Array, Array]  # q, v, a of shape (K, n) and time of shape (K,)

SAMPLES = 120  # states of each kind of motion, several times the parameters of any pair of effects
SLOW, FAST = 0.05, 3.0  # [rad/s or m/s], where Coulomb friction dominates, and where viscous friction does
UNHURRIED, BRISK, BRIEF = (
    60.0,
    12.0,
    6.0,
)  # [s], durations of a slow motion, of a fast one and of quick reversals
STROKE = 10  # states of one way at one speed
SHORT, NEAR = 0.3, 0.05  # [rad or m], amplitudes of a stroke at constant speed and of quick reversals
NEGLIGIBLE = 1e-9  # norm of a column beside the largest, or share of it that others leave, that is rounding
ENOUGH = 0.5  # share of the largest separation at which a simpler motion is preferred
NO_MOTION = "no motion of this arm does"  # how the answer begins where nothing can be driven
TINY = 1e-300  # guard against division by zero
WEIGHTLESS = 1e-9  # share of the largest joint's gravity torque below which gravity does not load a joint


@dataclass(frozen=True)
class MotionKind:
    """A kind of motion that a person can drive.

    Attributes:
        words: How to drive it, with places for one joint or several.
        draw: States along it, from a robot, which joints the explanations name, shape (n,), and a generator.
    """

    words: str
    draw: Callable[[RobotModel, NDArray[np.bool_], np.random.Generator], Draw]

    def said(self, joints: Sequence[str]) -> str:
        """Return how to drive it.

        Args:
            joints: Names of the joints that the explanations name; none if they are of the whole arm.
        """
        one = len(joints) == 1
        return self.words.format(
            the_joint="the joint" if one else "the joints", its="its" if one else "their"
        )


def distinguishing_motion(explanations: Sequence[Sequence[Effect]], robot: RobotModel) -> str:
    """Return in words the simplest motion in which explanations clearly differ.

    Whichever of two explanations is true must show what the other cannot imitate. The torque that is left of it, each
    parameter as large as makes one unit on its best motion, is compared with the largest of any motion. A pair in which
    one always imitates the other does not count.

    Args:
        explanations: Each the effects that explain together.
        robot: The arm.
    """
    named = tuple(dict.fromkeys(j for effects in explanations for e in effects for j in e.scope))
    motions = [_states(robot, kind, named) for kind in range(len(KINDS))]
    columns = [_scaled([_columns(effects, x) for x in motions]) for effects in explanations]
    pairs = list(permutations(columns, 2))
    left = np.array([[_left(true[k], fitted[k]) for true, fitted in pairs] for k in range(len(KINDS))])
    most = left.max(axis=0, initial=0.0)
    separable = most > NEGLIGIBLE
    if not separable.any():
        return KINDS[-1].said(named)
    scores = (left[:, separable] / most[separable]).min(axis=1)
    return next(
        k.said(named) for k, score in zip(KINDS, scores, strict=True) if score >= ENOUGH * scores.max()
    )


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
    plain = [[e.effect if isinstance(e, Varying) else e for e in effects] for effects in (one, other)]
    if plain[0] == plain[1]:
        return "they differ between logs or in time only: compare logs"
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


def _posture(robot: RobotModel, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return a posture away from the limits and the largest amplitude around it [rad or m], shape (n,) each."""
    lower, upper = robot.limits.usual_range(robot.is_prismatic)
    middle = (lower + upper) / 2
    posture = middle + rng.uniform(-0.1, 0.1, robot.n) * (upper - lower)
    return posture, np.minimum(posture - lower, upper - posture)


def _waves(centre: Array, amplitude: Array, cycles: Array, duration: float, rng: np.random.Generator) -> Draw:
    """Return a sum of sines on each joint, in time.

    Args:
        centre: Posture around which it moves [rad or m], shape (n,).
        amplitude: Of the whole motion [rad or m], shape (n,).
        cycles: Periods of each sine in the whole duration [1], shape (m, n).
        duration: Length [s].
        rng: Draws the phases.
    """
    time = np.linspace(0.0, duration, SAMPLES)
    w = 2 * np.pi * cycles / duration  # [rad/s], (m, n)
    angle = w * time[:, None, None] + rng.uniform(0.0, 2 * np.pi, cycles.shape)
    size = amplitude / len(cycles)
    q = centre + (size * np.sin(angle)).sum(axis=1)
    v, a = (size * w * np.cos(angle)).sum(axis=1), -(size * w**2 * np.sin(angle)).sum(axis=1)
    return q, v, a, time


def _slow_strokes(
    robot: RobotModel, moved: NDArray[np.bool_], strokes: Array, rng: np.random.Generator
) -> Draw:
    """Go through the range and back at constant speed.

    Args:
        robot: The arm.
        moved: Joints that do not stand still, shape (n,).
        strokes: How often each goes through its range [1], shape (n,).
        rng: Draws posture and phases.
    """
    centre, reach = _posture(robot, rng)
    speed = np.where(moved, SLOW, 0.0)
    time = np.linspace(0.0, float(np.max(2 * reach * strokes / SLOW)), SAMPLES)
    phase = np.outer(time, speed / (2 * reach)) + rng.uniform(0.1, 0.9, robot.n)  # in strokes
    back = np.floor(phase) % 2 == 1
    part = phase - np.floor(phase)
    q = centre + np.where(moved, reach * (1 - 2 * np.where(back, part, 1 - part)), 0.0)
    return q, np.where(back, -speed, speed), np.zeros_like(q), time


def _sweep(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    return _slow_strokes(robot, named if named.any() else ~named, np.full(robot.n, 3.0), rng)


def _poses(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    return _slow_strokes(robot, np.ones(robot.n, bool), rng.uniform(2.0, 5.0, robot.n), rng)


def _speeds(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    """Go forth and back at one constant speed after another, faster each time."""
    centre, reach = _posture(robot, rng)
    speed = np.repeat(np.geomspace(SLOW, FAST, SAMPLES // (2 * STROKE)), 2 * STROKE)
    way = np.tile(np.repeat([1.0, -1.0], STROKE), SAMPLES // (2 * STROKE))
    part = np.tile(
        np.concatenate([np.linspace(-1, 1, STROKE), np.linspace(1, -1, STROKE)]), len(speed) // (2 * STROKE)
    )
    stroke = np.minimum(reach, SHORT)
    q = centre + part[:, None] * stroke
    v = np.outer(way * speed, stroke / stroke.max())
    time = np.cumsum(2 * stroke.max() / (STROKE * speed))
    return q, v, np.zeros_like(q), time


def _reversals(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    centre, reach = _posture(robot, rng)
    cycles = rng.uniform(8.0, 12.0, (2, robot.n))
    return _waves(centre, np.minimum(reach, NEAR), cycles, BRIEF, rng)


def _everything(robot: RobotModel, named: NDArray[np.bool_], rng: np.random.Generator) -> Draw:
    centre, reach = _posture(robot, rng)
    q, v, a, time = _waves(centre, reach, rng.uniform(0.5, 6.0, (4, robot.n)), 1.0, rng)
    slower = float(np.abs(v).max()) / FAST
    return q, v / slower, a / slower**2, time * slower


# The simplest to drive comes first.
KINDS = (
    MotionKind("sweep {the_joint} slowly over {its} whole range, both ways", _sweep),
    MotionKind(
        "hold the arm in poses with gravity on and off {the_joint}, at rest and moving slowly", _poses
    ),
    MotionKind("move {the_joint} at several constant speeds, both ways, up to {its} fastest", _speeds),
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


def _columns(effects: Sequence[Effect], x: State) -> Array:
    """Return the torque of effects on a motion per unit of each parameter, shape (K n, p)."""
    return np.column_stack([np.zeros((x.q.size, 0)), *(e.basis(x).reshape(x.q.size, -1) for e in effects)])


def _scaled(columns: Sequence[Array]) -> list[Array]:
    """Return the columns of each motion in units of their RMS on the motion where that is largest."""
    largest = np.max([np.sqrt(np.mean(c**2, axis=0)) for c in columns], axis=0)
    return [c / np.maximum(largest, TINY) for c in columns]


def _left(true: Array, fitted: Array) -> float:
    """Return the largest RMS of a combination of columns that others cannot imitate [1]."""
    if not true.shape[1]:
        return 0.0
    norm = np.linalg.norm(fitted, axis=0)
    seen = norm > NEGLIGIBLE * norm.max(initial=0.0)
    basis, values, _ = np.linalg.svd(fitted[:, seen] / np.maximum(norm[seen], TINY), full_matrices=False)
    basis = basis[:, values > NEGLIGIBLE * values.max(initial=0.0)]
    outside = true - basis @ (basis.T @ true)
    return float(np.linalg.svd(outside, compute_uv=False)[0] / np.sqrt(len(true)))
