"""What an effect is mistaken for: how much of its torque another effect imitates along the standard motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear
from standard_motion import motion_for, robot

from cdia_pin.effects import EFFECTS, Effect, State, Term
from cdia_pin.identifiability import motion_between

EVERY = 12  # samples of the motion [1] of which one is enough
MOST = 3  # effects named [1]
LEAST = 0.5  # share [1] below which nobody mistakes one effect for the other


@dataclass(frozen=True)
class Imitation:
    """An effect that resembles another one.

    Attributes:
        effect: It.
        share: One minus the RMS that its best parameters leave, over the RMS of the torque imitated [1].
        motion: In words, the motion that tells the two apart.
    """

    effect: Effect
    share: float
    motion: str


def imitations(term: Term) -> list[Imitation]:
    """Return what imitates a term best, one for each name.

    Args:
        term: An effect with its numbers.
    """
    x = thinned(motion_for(term.effect))
    torque = term.torque(x)
    best: dict[str, tuple[float, Effect]] = {}
    for other in rivals(term.effect, x):
        share = imitated(torque, other, x)
        if share > best.get(other.name, (LEAST, other))[0]:
            best[other.name] = (share, other)
    ranked = sorted(best.values(), key=lambda pair: (-round(pair[0], 3), pair[1].size))[:MOST]
    return [Imitation(other, share, motion_between(term.effect, other, robot())) for share, other in ranked]


def rivals(effect: Effect, x: State) -> Iterator[Effect]:
    """Yield the effects of other names that act where an effect acts, in every shape that a search would try."""
    joints, sensed = set(effect.acts_on(x.robot)), effect.traits.sensed
    for kind in EFFECTS.values():
        if kind.name == effect.name or not kind.plausibility.searched or not kind.traits.sensed.meets(sensed):
            continue
        for scope in kind.scopes(x.robot):
            other = kind.from_scope(scope, {})
            if joints <= set(other.acts_on(x.robot)):
                yield from other.shape_grid(x)


def imitated(torque: np.ndarray, other: Effect, x: State) -> float:
    """Return the share of a torque that the best possible parameters of another effect explain [1]."""
    columns = other.basis(x).reshape(torque.size, -1)
    size = np.linalg.norm(columns, axis=0)
    seen = size > 0
    if not seen.any():
        return 0.0
    lower, upper = (bound[seen] * size[seen] for bound in other.bounds(x.robot))
    fit = lsq_linear(columns[:, seen] / size[seen], torque.ravel(), (lower, upper))
    return 1.0 - float(np.sqrt(2 * fit.cost) / np.linalg.norm(torque))


def thinned(x: State) -> State:
    """Return every few samples of a motion."""
    warmth = None if x.temperature is None else x.temperature[::EVERY]
    q, v, a, effort, time = (signal[::EVERY] for signal in (x.q, x.v, x.a, x.effort, x.time))
    return State(x.robot, q, v, a, effort, time, temperature=warmth)
