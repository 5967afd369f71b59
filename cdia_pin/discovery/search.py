"""Search for the set of effects with the least cost: add, drop, swap, split and merge until nothing helps."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from cdia_pin.discovery.evidence import Evidence, Fit

Names = frozenset[str]

TRIED = 6  # candidates that are fitted after the gains have ranked them
HOLDS = 0.5  # least share of a gain that is left on held-out blocks
MARGIN = 1e-6  # a move must gain more than rounding


def improve(
    evidence: Evidence, chosen: Sequence[int], tabu: Collection[Names], *, most: int, may_add: bool = True
) -> Fit | None:
    """Return the best set that one move leads to, or None if no move lowers the cost.

    Dropping comes before the other moves, so that an effect which a later one made needless never guides the search.

    Args:
        evidence: Normal equations of the candidates.
        chosen: Indices of the present set.
        tabu: Sets that were tried and turned out worse than the normal equations promised.
        most: Largest number of effects.
        may_add: False to only prune.
    """
    now = evidence.fit(chosen)
    fresh = lambda f: names(evidence, f.chosen) not in tabu  # noqa: E731
    needless = [f for f in map(evidence.fit, _drops(now.chosen)) if not now.physical or not _misses(evidence, now, f)]
    if needless and now.chosen:
        return min(needless, key=lambda f: f.cost)
    if not may_add:
        return None
    additions = _additions(evidence, now.chosen) if len(now.chosen) < most else iter(())
    for moves in (additions, _exchanges(evidence, now.chosen)):
        better = [f for f in map(evidence.fit, moves) if f.physical and f.cost < now.cost - MARGIN and fresh(f)]
        if better:
            return min(better, key=lambda f: f.cost)
    return None


def _misses(evidence: Evidence, whole: Fit, part: Fit) -> bool:
    """Tell whether a set misses the effect that it lacks beside the whole."""
    (lacking,) = set(whole.chosen) - set(part.chosen)
    if not part.physical:
        return True
    gain = part.chi2 - whole.chi2
    return gain >= evidence.least_gain[lacking] and _holds(evidence, whole, part, gain)


def _holds(evidence: Evidence, whole: Fit, part: Fit, gain: float) -> bool:
    """Tell whether what an effect explains is explained in blocks of time that it was not fitted to as well."""
    return evidence.held_out(part.chosen) - evidence.held_out(whole.chosen) > HOLDS * gain


def names(evidence: Evidence, chosen: Sequence[int]) -> Names:
    """Return what a set is called, whatever its shapes."""
    return frozenset(evidence.effects[c].label for c in chosen)


def _drops(chosen: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    for c in chosen:
        yield tuple(x for x in chosen if x != c)


def ranked(evidence: Evidence, chosen: Sequence[int], count: int, spare: float = 0.0) -> list[int]:
    """Return the candidates whose gain beside a set best repays their price, at most `count`.

    Args:
        evidence: Normal equations of the candidates.
        chosen: The set.
        count: How many to return.
        spare: Cost that may be lost beyond the price.
    """
    gains = evidence.gains(chosen)
    profit = np.where(gains > evidence.least_gain - spare, gains - evidence.price, -np.inf)
    labels = {evidence.effects[c].label for c in chosen}
    order = [int(c) for c in np.argsort(profit)[::-1] if profit[c] > -spare and np.isfinite(profit[c])]
    return [c for c in order if evidence.effects[c].label not in labels][:count]


def _additions(evidence: Evidence, chosen: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    for c in ranked(evidence, chosen, TRIED):
        with_it = (*chosen, c)
        yield with_it
        # what the addition made needless or unphysical goes in the same move
        yield from (tuple(x for x in with_it if x != other) for other in chosen)


def _exchanges(evidence: Evidence, chosen: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Yield sets with one effect for another, two for one, one for two."""
    for c in chosen:
        rest = tuple(x for x in chosen if x != c)
        lost = evidence.fit(rest).cost - evidence.fit(chosen).cost
        for other in ranked(evidence, rest, TRIED, spare=-min(lost, 0.0)):
            if other == c:
                continue
            yield (*rest, other)
            if evidence.effects[c].size > 1:
                yield from ((*rest, other, third) for third in ranked(evidence, (*rest, other), 3) if third != c)
        for second in rest:
            if second > c and _touch(evidence, c, second):
                fewer = tuple(x for x in rest if x != second)
                yield from ((*fewer, other) for other in ranked(evidence, fewer, 3) if other not in {c, second})


def _touch(evidence: Evidence, one: int, two: int) -> bool:
    robot = evidence.robot
    return bool(set(evidence.effects[one].acts_on(robot)) & set(evidence.effects[two].acts_on(robot)))
