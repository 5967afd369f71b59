"""The verdict of a discovery, and the rule that decides it."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum


class DiscoveryVerdict(StrEnum):
    """What a discovery concludes."""

    NOTHING_MISSING = "nothing-missing"
    EXPLAINED = "explained"
    UNEXPLAINED = "unexplained"


def verdict_on(structure_left: Sequence[str], added: int) -> DiscoveryVerdict:
    """Return the verdict: structure that is left outweighs all that was found.

    Args:
        structure_left: Names of the joints whose residual is not noise.
        added: Number of effects that were added.
    """
    if structure_left:
        return DiscoveryVerdict.UNEXPLAINED
    return DiscoveryVerdict.EXPLAINED if added else DiscoveryVerdict.NOTHING_MISSING
