"""A change is certain beside the same effect in all logs.

Of what not every arm has, only a little may be common to both sides. So a ripple that both have looks like a ripple
that came, where the joint is at other positions before and after. Beside a ripple of any size in all logs it is none:
on a Kinova Gen3 its estimate is 0.6 to 1.1 standard deviations then, those of ripples that were put in are 6 and more.
A ripple may be larger at one place of the joint than at another, so all logs may have those of nearly its frequency
too: on an arm of two RMD drives a ripple that is not there has 0.6 in place of 2.4 standard deviations then.
"""

from __future__ import annotations

from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.common_structure import is_rare
from cdia_pin.changes.linearisation import CLEAR


def certain_beside_both(search: ChangeSearch, chosen: tuple[int, ...]) -> tuple[int, ...]:
    """Return the changes that are certain beside the same effects, of any size, in all logs.

    Args:
        search: The search, with the evidence for all changes.
        chosen: Indices of what it found.
    """
    differing = search.differing
    changes = [search.evidence.effects[c] for c in chosen]
    present = {t.effect for t in differing.prediction.model.terms}
    rare = [c for c in changes if is_rare(c.effect, present)]
    if not rare:
        return chosen
    x = differing.experiment.along(differing.prediction)
    alike = (effect for c in rare for effect in (c.effect, *c.effect.nearly_alike(x)))
    evidence = differing.beside_both(changes, list(dict.fromkeys(alike)))

    def certainty(k: int) -> float:
        others = [other for other in range(len(changes)) if other != k]
        return float(evidence.fits(others).certainty[k])

    pairs = enumerate(zip(chosen, changes, strict=True))
    return tuple(c for k, (c, change) in pairs if change not in rare or certainty(k) >= CLEAR)
