"""Moves of the search: add, drop, swap, split and merge effects while the cost falls."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from cdia_pin.effects.effect import share_a_joint
from cdia_pin.selection.evidence import Evidence, SetFit

Names = frozenset[str]
Allowed = Callable[[tuple[int, ...]], bool]

# Joints [1] that an effect may act on to be split or merged; all pairs of larger effects would take long.
LOCAL = 2
# Candidates [1] of largest gain that are fitted at each move, because a fit takes longer than a gain.
TRIED = 5
# Candidates [1] tried when two effects take the place of one, or one that of two, because each gives many pairs.
TRIED_IN_PAIRS = 3
# [1], share of what is left that an addition must explain which impossible ones hide. On a six-joint arm whose sixth
# effort is reversed 0.2 gives the same answers for two motions; 0.05 gives a payload more in one of them. Without a
# share the search on a UR10 goes on by unusual effects that explain 0.06 or less, and takes four times as long.
HIDDEN = 0.1


def improve(evidence: Evidence, chosen: Sequence[int], allowed: Allowed, *, most: int) -> SetFit | None:
    """Return the best set that one move leads to, or None if no move lowers the cost.

    Dropping comes before the other moves, so that an effect which has become needless never guides the search.

    Args:
        evidence: Evidence for the candidates.
        chosen: Indices of the present set.
        allowed: Returns True for sets that may be tried; others have failed at their own optimum.
        most: Largest number of effects [1].
    """
    criterion, now = evidence.criterion, evidence.fit(chosen, bodies=True)
    needless = [
        part for c in now.chosen if (part := _without(evidence, now, c)) is not None and allowed(part.chosen)
    ]
    if needless:
        return min(needless, key=lambda f: f.cost)
    if len(now.chosen) < most:
        additions = filter(allowed, _additions(now.chosen, ranked(evidence, now.chosen, TRIED)))
        better = _cheapest(evidence, now, additions, allowed, now.cost - criterion.margin)
        if better is not None and (not now.physical or holds(evidence, now, better)):
            return better
    exchanges = [m for m in _exchanges(evidence, now.chosen) if allowed(m)]
    # far above the noise, a small gain does not count
    margin = max(criterion.margin, criterion.exchange_share * (now.chi2 - evidence.samples))

    def count(chosen: tuple[int, ...]) -> float:
        return float(evidence.effective_parameters[list(chosen)].sum())

    simpler = [m for m in exchanges if len(m) <= len(now.chosen) or count(m) < count(now.chosen)]
    better = _cheapest(evidence, now, simpler, allowed, now.cost - margin)
    if better is not None:
        return better
    # two effects for one, with more parameters, must explain enough for the additional name
    least = float(np.max(evidence.least_gain[list(now.chosen)], initial=0.0))
    better = _cheapest(evidence, now, exchanges, allowed, now.cost - margin - least)
    if better is not None or not now.physical or len(now.chosen) == most:
        return better
    return _hidden(evidence, now, allowed)


def _hidden(evidence: Evidence, now: SetFit, allowed: Allowed) -> SetFit | None:
    """Return the best addition that impossible ones of larger gain hide, or None if none explains much.

    Where the effort of a joint has the wrong sign, several kinds of friction explain it that would have to push.
    """
    gains, enough = evidence.gains(now.chosen, bounded=True), HIDDEN * now.chi2
    hidden = [c for c in ranked(evidence, now.chosen, TRIED, bounded=True) if gains[c] > enough]
    better = _cheapest(
        evidence, now, filter(allowed, _additions(now.chosen, hidden)), allowed, now.cost - enough
    )
    return better if better is not None and holds(evidence, now, better) else None


def _cheapest(
    evidence: Evidence, now: SetFit, sets: Iterable[tuple[int, ...]], allowed: Allowed, limit: float
) -> SetFit | None:
    """Return the physical fit of least cost below a limit; sets whose bound is above the best are not fitted.

    A set that makes an effect reduce to a simpler one is tried with that one in its place, if that is allowed: a
    friction that fell with the speed may be plain once another effect is there.
    """
    best = None
    for bound, chosen in sorted((evidence.bound(c), c) for c in {tuple(sorted(c)) for c in sets}):
        if bound >= (best.cost if best else limit):
            break
        below = best.cost if best else limit
        if evidence.bounded_chi2(chosen, now) + evidence.penalty_of(chosen) >= below:
            continue
        rough = evidence.fit(chosen)
        plainer = None if rough.physical else evidence.simpler_set(rough)
        if plainer is not None and allowed(plainer):
            rough = evidence.fit(plainer)
        if rough.physical and rough.cost < below:
            fit = evidence.fit(rough.chosen, bodies=True)
            best = fit if fit.physical and fit.cost < below else best
    return best


def _without(evidence: Evidence, whole: SetFit, lacking: int) -> SetFit | None:
    """Return the fit without an effect if the effect explains too little to stay, otherwise None."""
    rest = tuple(c for c in whole.chosen if c != lacking)
    needed = missed(evidence, lacking)
    if whole.physical and evidence.free_chi2(rest) - whole.chi2 >= needed:
        return None
    if whole.physical and evidence.bounded_chi2(rest, whole) - whole.chi2 >= needed:
        return None
    part = evidence.fit(rest, bodies=True)
    return None if whole.physical and part.physical and part.chi2 - whole.chi2 >= needed else part


def missed(evidence: Evidence, one: int) -> float:
    """Return the sum of squares that an effect must explain to stay in its set [1].

    It is less than for an addition, so that an effect is not added and dropped by turns.

    Args:
        evidence: Evidence for the candidates.
        one: Index of the effect.
    """
    stays = evidence.criterion.staying_share * float(evidence.least_gain[one])
    return max(float(evidence.penalty[one]), stays)


def holds(evidence: Evidence, before: SetFit, after: SetFit) -> bool:
    """Return True if the gain of an addition holds on held-out blocks of time too.

    Args:
        evidence: Evidence for the candidates.
        before: Fit of the set without the addition.
        after: Fit of the set with it.
    """
    gain = before.chi2 - after.chi2
    added = [c for c in after.chosen if c not in before.chosen]
    if gain > evidence.criterion.clear_gain * max(evidence.least_gain[c] for c in added):
        return True
    left, left_then = (evidence.equations.held_out(f.chosen, f.theta) for f in (before, after))
    return left - left_then > evidence.criterion.heldout_share * gain


def names(evidence: Evidence, chosen: Sequence[int]) -> Names:
    """Return the labels of a set, which do not depend on the shapes.

    Args:
        evidence: Evidence for the candidates.
        chosen: Indices of the set.
    """
    return frozenset(evidence.labels[c] for c in chosen)


def ranked(
    evidence: Evidence, chosen: Sequence[int], count: int, spare: float = 0.0, *, bounded: bool = False
) -> list[int]:
    """Return the effects whose gain exceeds their penalty most when they are added to a set, each in its best shape.

    Args:
        evidence: Evidence for the candidates.
        chosen: Indices of the set.
        count: Largest number of effects to return [1].
        spare: Cost by which the penalty may exceed the gain [1].
        bounded: Rank by gains of possible parameters.
    """
    gains = evidence.gains(chosen, bounded=bounded)
    profit = np.where(gains > evidence.least_gain - spare, gains - evidence.penalty, -np.inf)
    taken = {evidence.labels[c] for c in chosen}
    out: list[int] = []
    for c in np.argsort(profit)[::-1]:
        if not profit[c] > -spare or len(out) == count:
            break
        label = evidence.labels[c]
        if label not in taken:  # only the best shape of each effect
            taken.add(label)
            out.append(int(c))
    return out


def _additions(chosen: tuple[int, ...], candidates: Iterable[int]) -> Iterator[tuple[int, ...]]:
    for c in candidates:
        with_it = (*chosen, c)
        yield with_it
        # an effect that the addition makes needless or unphysical is dropped in the same move
        yield from (tuple(x for x in with_it if x != other) for other in chosen)


def _exchanges(evidence: Evidence, chosen: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Yield sets with one effect for another and, within a joint, two for one and one for two."""
    local = [c for c in chosen if len(evidence.effects[c].acts_on(evidence.robot)) <= LOCAL]
    for c in chosen:
        rest = tuple(x for x in chosen if x != c)
        lost = evidence.bound(rest) - evidence.fit(chosen, bodies=True).cost
        for other in ranked(evidence, rest, TRIED, spare=-min(lost, 0.0)):
            if other == c:
                continue
            yield (*rest, other)
            if c in local and evidence.effects[c].size > 1:
                yield from (
                    (*rest, other, third)
                    for third in ranked(evidence, (*rest, other), TRIED_IN_PAIRS)
                    if third != c
                )
        for second in local:
            if c not in local or second <= c:
                continue
            if share_a_joint(evidence.effects[c], evidence.effects[second], evidence.robot):
                fewer = tuple(x for x in rest if x != second)
                yield from (
                    (*fewer, other)
                    for other in ranked(evidence, fewer, TRIED_IN_PAIRS)
                    if other not in {c, second}
                )
