"""Settings of a discovery."""

from __future__ import annotations

from dataclasses import dataclass, field

from cdia_pin.effects import Effect
from cdia_pin.logs.conditioning import Conditioning
from cdia_pin.selection.criterion import SelectionCriterion


@dataclass(frozen=True)
class DiscoverySettings:
    """What is searched for and how.

    Attributes:
        conditioning: How logs are filtered.
        effects: Names of the vocabulary that may be found; all but ``unknown`` and ``expression`` if None.
        extra: Effects of the user's own that may be found as well.
        per_log: Effects, by name or label, whose parameters are each log's own in any case.
        most_effects: The search ends with this many effects in the model.
        blocks: Number of contiguous blocks of time for held-out errors and intervals.
        criterion: What an effect must explain to be named.
    """

    conditioning: Conditioning = field(default_factory=Conditioning)
    effects: tuple[str, ...] | None = None
    extra: tuple[Effect, ...] = ()
    per_log: tuple[str, ...] = ()
    most_effects: int = 40
    blocks: int = 10
    criterion: SelectionCriterion = field(default_factory=SelectionCriterion)
