"""What changed between logs, in the terminal: errors by log, changes with sizes, bounds on hidden changes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table

from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.change_words import (
    change_rows,
    changes_sentence,
    doubts,
    is_quiet,
    names_of_logs,
    notes,
)
from cdia_pin.viewers.words import percent, short_names

if TYPE_CHECKING:
    from cdia_pin.changes import Changes
    from cdia_pin.discovery import Comparison


def errors_by_log(comparisons: Sequence[Comparison]) -> Table:
    """Return the error of a model in each log, joint by joint, as a share of the measured torque.

    Args:
        comparisons: The outcome of ``compare`` for each log.
    """
    joints = comparisons[0].model.robot.joints
    names = short_names(joints)
    table = new_table(
        "error, % of torque RMS", *(names[j].replace("_", "\n", 1) for j in joints), "mean", left=(0,)
    )
    for name, c in zip(names_of_logs(comparisons), comparisons, strict=True):
        shares = [*c.relative_rms, c.mean_error]
        add_row(
            table,
            name,
            *(percent(s).rstrip("% \N{NO-BREAK SPACE}") for s in shares),
        )
    return table


def changes_table(found: Changes) -> RenderableType:
    """Return what changed, how sure that is, and what could have changed unseen.

    Args:
        found: The outcome of ``what_changed``.
    """
    said = clean(changes_sentence(found), "bold green" if is_quiet(found) else "bold yellow")
    parts: list[RenderableType] = [Padding(said, (0, 1))]
    if found.changes:
        parts.append(_changes(found))
    parts += [Padding(clean(s, "italic"), (0, 1)) for s in doubts(found)]
    parts += [Padding(clean(s), (0, 1)) for s in notes(found)]
    return Group(*parts)


def _changes(found: Changes) -> Table:
    rows = change_rows(found)
    grown = ["of before"] if any(row.growth for row in rows) else []
    heads = ("changed", "joint", "difference ± 95 %", *grown, "largest torque", "confidence")
    table = new_table(*heads, left=(0, 1, 2, len(heads) - 1))
    for row in rows:
        growth = [row.growth] if grown else []
        add_row(
            table, row.name, row.where, "\n".join(row.differences), *growth, row.torque, str(row.confidence)
        )
    table.caption = (
        "torque: RMS in the logs that have it\n"
        "A difference acts on the arm: the measured torque changes by the opposite."
    )
    return table
