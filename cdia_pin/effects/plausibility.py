"""Plausibility: how readily a search believes in an effect, beside how well it fits."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plausibility:
    """How readily a search believes in an effect, beside how well it fits. It is no physics.

    Attributes:
        penalty: What the effect must explain more than another explanation to be preferred to it, added to its
            penalty [1, as χ²].
        collective: Whether the effect stands for many small errors at once. Then it needs no large torque to be
            named, and no single effect takes its place.
    """

    penalty: float = 0.0
    collective: bool = False
