"""What would tell equal explanations apart, in words, from the signals that their formulas read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.effects import JointEffect, JointState, Term

MOTIONS = {
    "q": "reach other positions of the joint",
    "v": "move the joint at several speeds, in both directions",
    "a": "accelerate and brake the joint harder",
    "effort": "load the joint differently",
}


def what_separates(combinations: Sequence[Sequence[Term]]) -> str:
    """Return a sentence that names equal combinations and the motion that would tell them apart."""
    names = [" with ".join(t.effect.name for t in terms) or "none" for terms in combinations]
    reads = [frozenset().union(*(signals_of(t.effect) for t in terms)) for terms in combinations]  # type: ignore[arg-type]
    differing = frozenset().union(*reads) - frozenset.intersection(*reads)
    motions = [MOTIONS[s] for s in MOTIONS if s in differing] or list(MOTIONS.values())[:2]
    return f"{' and '.join(names)} explain this motion alike; to tell them apart, {' and '.join(motions)}"


def signals_of(effect: JointEffect) -> frozenset[str]:
    """Return which signals of its joint the torque of an effect changes with: q, v, a, effort."""
    ones = np.array([0.3, 0.3])
    base = {"q": ones, "v": ones, "a": ones, "effort": ones}
    moved = np.array([0.3, 0.9])

    def columns(**signals: np.ndarray) -> np.ndarray:
        x = {**base, **signals}
        sign = np.sign(x["v"])
        return np.array(effect.columns(JointState(x["q"], x["v"], x["a"], x["effort"], sign, np.zeros(2))))

    found = {s for s in base if not np.allclose(np.diff(columns(**{s: moved}), axis=1), 0.0)}
    if not np.allclose(np.diff(columns(v=np.array([0.3, -0.3])), axis=1), 0.0):
        found.add("v")
    return frozenset(found)
