"""The ranking of single candidates, as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table

from cdia_pin.viewers.cells import clean, new_table
from cdia_pin.viewers.verdict import unseen_share
from cdia_pin.viewers.words import confusion_words, effect_words, few, number, percent, with_unit

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Ranked

SHOWN = 4  # candidates, unless all are asked for
NAMED = 2  # parameters, and other explanations, of each


def ranking_table(found: Discovery, everything: bool = False) -> Table:
    """Return the best candidates, each fitted alone beside the model as given.

    Args:
        found: The outcome of ``discover``.
        everything: Whether all are shown, not only the first few.
    """
    table = new_table("by itself", "held-out error", "parameters", "could also be", left=(0, 2, 3))
    for r in found.ranking[: None if everything else SHOWN]:
        before, after = (percent(unseen_share(e, found)) for e in (r.heldout_before, r.heldout_after))
        said = clean(effect_words(r.term.effect))
        cells = (
            "\n".join(_parameters(r, found)),
            ", ".join(few((confusion_words(c) for c in r.confusions), NAMED)),
        )
        table.add_row(said, clean(f"{before} → {after}"), *map(clean, cells))
    hidden = len(found.ranking) - table.row_count
    table.caption = (
        "each candidate fitted alone beside the model as given; error over torque RMS, mean of joints"
    )
    table.caption += f"; {hidden} more with --all" if hidden else ""
    return table


def _parameters(ranked: Ranked, found: Discovery) -> list[str]:
    """Return the parameters that differ from zero most clearly."""
    term = ranked.term
    units = term.effect.units(found.model.robot)
    ends = term.ci95 or tuple((v, v) for v in term.theta)
    rows = zip(term.values.items(), units, ends, strict=True)
    clear = [
        (abs(value) / max(upper - lower, 1e-12), f"{name} {with_unit(number(value), unit)}")
        for (name, value), unit, (lower, upper) in rows
    ]
    kept = sorted(sorted(clear, reverse=True)[:NAMED], key=clear.index)
    left = len(clear) - len(kept)
    return [text for _, text in kept] + ([f"({left} more)"] if left else [])
