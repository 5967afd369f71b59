"""A change is certain beside the same effect in all logs.

Of what not every arm has, only a little may be common to both sides. So a ripple that both have looks like a ripple
that came, where the joint is at other positions before and after. Beside a ripple of any size in all logs it is none:
on a Kinova Gen3 its estimate is 0.6 to 1.1 standard deviations then, those of ripples that were put in are 6 and more.
A ripple may be larger at one place of the joint than at another, so all logs may have those of nearly its frequency
too: on an arm of two RMD drives a ripple that is not there has 0.6 in place of 2.4 standard deviations then.

What changed may be something else. So where such an effect is no change, all logs have it, and the search begins again.
"""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.common_structure import is_rare
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.linearisation import CLEAR
from cdia_pin.effects import Effect
from cdia_pin.selection.discovery_settings import DiscoverySettings


def search_beside_both(
    differing: Differing, settings: DiscoverySettings
) -> tuple[ChangeSearch, tuple[int, ...]]:
    """Search for changes that are certain beside the same effects, of any size, in all logs.

    Args:
        differing: Logs before and after.
        settings: What may have changed.

    Returns:
        The search, and the indices of the changes in its evidence.
    """
    while True:
        search = ChangeSearch(differing, differing.evidence(), settings.changes)
        chosen = search.changes(settings.most_effects)
        unchanged = _unchanged(search, chosen)
        if not unchanged:
            return search, chosen
        differing = differing.with_both(_with_alike(differing, unchanged))


def _unchanged(search: ChangeSearch, chosen: Sequence[int]) -> list[Effect]:
    """Return the effects that seem to have changed only because few of them may be common to all logs."""
    differing = search.differing
    changes = [search.evidence.effects[c] for c in chosen]
    present = {t.effect for t in differing.prediction.model.terms}
    rare = [c for c in changes if is_rare(c.effect, present)]
    if not rare:
        return []
    both = differing.with_both(_with_alike(differing, [c.effect for c in rare]))
    evidence = both.evidence_for(changes)

    def certainty(k: int) -> float:
        others = [other for other in range(len(changes)) if other != k]
        return float(evidence.fits(others).certainty[k])

    return [c.effect for k, c in enumerate(changes) if c in rare and certainty(k) < CLEAR]


def _with_alike(differing: Differing, effects: Sequence[Effect]) -> list[Effect]:
    """Return effects, and those that are nearly alike along the logs, each once."""
    x = differing.experiment.along(differing.prediction)
    return list(dict.fromkeys(alike for e in effects for alike in (e, *e.nearly_alike(x))))
