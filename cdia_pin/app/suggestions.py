"""The suggestions of a search, in words and numbers that a page shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery import Discovery
from cdia_pin.effects import Term
from cdia_pin.identifiability import Confusion
from cdia_pin.viewers.effect_groups import rivals, term_of
from cdia_pin.viewers.parameter_rows import (
    ParameterRow,
    parameters,
    parts_words,
    shape_parameters,
    step_parameters,
)
from cdia_pin.viewers.verdict import unseen_share
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
        parts: Both parts of their intervals; empty where they are not known.
        more: How many parameters are not shown.
        before: Error on data that was not fitted, over torque RMS, mean over the joints [1].
        after: The same with it.
        confidence: How far its name can be trusted; None if the search would not add it.
        confusions: Other explanations in words, each with the motion that would distinguish them.
    """

    text: str
    name: str
    where: str
    numbers: tuple[str, ...]
    parts: str
    more: int
    before: float
    after: float
    confidence: Confidence | None
    confusions: tuple[tuple[str, str], ...]

    @property
    def chosen(self) -> bool:
        """Whether the search would add it, together with those before it in the list."""
        return self.confidence is not None


def suggestions(found: Discovery) -> list[Suggestion]:
    """Return the effects of the search in its order, then others that would lower the error alone.

    Args:
        found: The outcome of the search.
    """
    out = [
        _suggestion(
            step_parameters(step, found.model.robot),
            term_of(step),
            found,
            before.heldout_rms,
            step.heldout_rms,
            step.confusions,
            step.confidence,
        )
        for before, step in zip(found.trace, found.steps, strict=False)
    ]
    taken = {s.text for s in out}
    return out + [
        _suggestion(
            parameters(r.term, found.model.robot),
            r.term,
            found,
            r.heldout_before,
            r.heldout_after,
            r.confusions,
            None,
        )
        for r in found.ranking
        if r.term.label not in taken
    ]


def _suggestion(
    rows: list[ParameterRow],
    term: Term,
    found: Discovery,
    before: np.ndarray,
    after: np.ndarray,
    confusions: tuple[Confusion, ...],
    confidence: Confidence | None,
) -> Suggestion:
    robot = found.model.robot
    telling = [r for r in rows if r["telling"]] or rows
    shown = [*shape_parameters(term, robot), *telling][:TELLING]
    return Suggestion(
        text=term.label,
        name=effect_name(term.effect),
        where=where_words(term.effect),
        numbers=tuple(f"{r['name']} {r['text']}" for r in shown),
        parts="; ".join(f"{r['name']} {parts_words(r)}" for r in telling[:TELLING] if r["parts"]),
        more=max(len(rows) + len(term.effect.shape) - len(shown), 0),
        before=unseen_share(before, found),
        after=unseen_share(after, found),
        confidence=confidence,
        confusions=tuple((confusion_words(c), c.motion) for c in rivals(term.effect, confusions)),
    )
