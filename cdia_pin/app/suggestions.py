"""The suggestions of a search, in words and numbers that a page shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdia_pin.discovery import Discovery
from cdia_pin.effects import Term
from cdia_pin.identifiability import Confusion
from cdia_pin.viewers.parameter_rows import parameters, shape_parameters
from cdia_pin.viewers.verdict import mean_share
from cdia_pin.viewers.words import confusion_words, effect_name, where_words

TELLING = 3  # parameters that are shown of an effect


@dataclass(frozen=True)
class Suggestion:
    """One effect that could be added.

    Attributes:
        text: As `Session.add` takes it.
        name: In words.
        where: Joints, or ``whole arm``.
        numbers: Its most significant parameters, each with unit and interval.
        more: How many parameters are not shown.
        before: Error on data that was not fitted, over torque RMS, mean over the joints [1].
        after: The same with it.
        chosen: Whether the search would add it, together with those before it in the list.
        plausible: Whether its fit is physical without being held at a bound.
        confusions: Other explanations in words, each with the motion that would distinguish them.
    """

    text: str
    name: str
    where: str
    numbers: tuple[str, ...]
    more: int
    before: float
    after: float
    chosen: bool
    plausible: bool
    confusions: tuple[tuple[str, str], ...]


def suggestions(found: Discovery) -> list[Suggestion]:
    """Return the effects of the search in its order, then others that would lower the error alone.

    Args:
        found: The outcome of the search.
    """
    out = [
        _suggestion(
            step.term,
            found,
            before.heldout_rms,
            step.heldout_rms,
            step.confusions,
            chosen=True,
            plausible=True,
        )
        for before, step in zip(found.trace, found.steps, strict=False)
        if step.term is not None
    ]
    taken = {s.text for s in out}
    return out + [
        _suggestion(r.term, found, r.heldout_before, r.heldout_after, r.confusions, False, r.plausible)
        for r in found.ranking
        if r.term.label not in taken
    ]


def _suggestion(
    term: Term,
    found: Discovery,
    before: np.ndarray,
    after: np.ndarray,
    confusions: tuple[Confusion, ...],
    chosen: bool,
    plausible: bool,
) -> Suggestion:
    robot = found.model.robot
    rows = parameters(term, robot)
    telling = [r for r in rows if r["telling"]] or rows
    shown = [*shape_parameters(term, robot), *telling][:TELLING]
    return Suggestion(
        text=term.label,
        name=effect_name(term.effect),
        where=where_words(term.effect),
        numbers=tuple(f"{r['name']} {r['text']}" for r in shown),
        more=max(len(rows) + len(term.effect.shape) - len(shown), 0),
        before=mean_share(before, found),
        after=mean_share(after, found),
        chosen=chosen,
        plausible=plausible,
        confusions=tuple((confusion_words(c), c.motion) for c in confusions),
    )
