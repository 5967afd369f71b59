"""Plausibility: how likely an effect is before any data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plausibility:
    """How likely an effect is before any data; a search asks less likely effects for more evidence.

    Attributes:
        penalty: Added to the effect's penalty in the criterion, in variances of the noise [1].
        collective: Whether the effect stands for many small errors at once. Then it needs no large torque to be
            named, and no single effect takes its place.
        unusual: Whether an arm in use hardly ever has it, so that it needs far more evidence or the user's word.
        searched: Whether a search of a log asks for it without being told to.
    """

    penalty: float = 0.0
    collective: bool = False
    unusual: bool = False
    searched: bool = True

    @property
    def is_common(self) -> bool:
        """True for what most arms have: it has no penalty, and tells the noise before a search."""
        return self.penalty == 0.0
