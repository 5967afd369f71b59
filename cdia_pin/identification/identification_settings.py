"""Settings of an identification."""

from __future__ import annotations

from dataclasses import dataclass, field

from cdia_pin.logs.conditioning import Conditioning


@dataclass(frozen=True)
class IdentificationSettings:
    """How logs are filtered, and what may be fitted to them.

    Attributes:
        conditioning: How logs are filtered.
        strength: How firmly bodies are held to the URDF, see `urdf_precision` [1]; chosen by cross-validation if None.
        refine: Whether friction may follow richer laws than Coulomb's and viscous friction, where the log asks for it.
        blocks: Contiguous blocks of time for cross-validation, held-out errors and intervals.
    """

    conditioning: Conditioning = field(default_factory=Conditioning)
    strength: float | None = None
    refine: bool = True
    blocks: int = 10
