"""Tables of claims: those with a target together, then part by part and arm by arm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from benchmarks.claims import Claim, Part
from benchmarks.markdown import Row, table

MUST_SHOW = ("claim", "target", "measured", "n", "met")  # heads


def targets(parts: Sequence[Part], outcomes: Sequence[Any]) -> Iterator[Row]:
    """Yield a row for each claim that has a target and something to measure."""
    for part in parts:
        chosen = [o for o in outcomes if part.chosen(o)]
        for claim in part.claims if chosen else ():
            if claim.target:
                f = claim.measure(chosen)
                yield (f"{part.title}: {claim.text}", claim.target, f.text, f.n, claim.says(f.value))


def by_part(
    parts: Sequence[Part], outcomes: Sequence[Any], arms: Sequence[str], arm_of: Callable[[Any], str]
) -> Iterator[str]:
    """Yield the title, the words and the table of each part that something was measured for.

    Args:
        parts: The parts.
        outcomes: What was measured.
        arms: Names of the arms, a column each.
        arm_of: From an outcome to its arm's name.
    """
    for part in parts:
        chosen = [o for o in outcomes if part.chosen(o)]
        if chosen:
            of_arms = [[o for o in chosen if arm_of(o) == arm] for arm in arms]
            yield f"## {part.title}"
            yield part.about
            yield table(
                ("", "target", "all arms", "n", "met", *arms),
                (_row(claim, chosen, of_arms) for claim in part.claims),
            )


def _row(claim: Claim, chosen: Sequence[Any], of_arms: Sequence[Sequence[Any]]) -> Row:
    f = claim.measure(chosen)
    each = (claim.measure(some).text for some in of_arms)
    return (claim.text, claim.target or "–", f.text, f.n, claim.says(f.value), *each)
