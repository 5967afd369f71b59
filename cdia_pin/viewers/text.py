"""Comparisons and checks in the terminal, as things that ``rich`` prints in 80 columns or more."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.text_discovery import addition_table, discovery_table
from cdia_pin.viewers.words import joint_units, number, percent, region_words, short_names, with_unit

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison
    from cdia_pin.logs import LogCheck

__all__ = ["addition_table", "check_table", "comparison_table", "discovery_table", "where_it_fails"]

MARKS = {"ok": ("✓", "green"), "info": ("·", "blue"), "warning": ("!", "yellow"), "error": ("✗", "red")}


def comparison_table(comparison: Comparison) -> Table:
    """Return the errors of a model by joint.

    Args:
        comparison: The outcome of ``compare``.
    """
    robot = comparison.model.robot
    heads = ("joint", "torque RMS", "error RMS", "error", "bias", "lag 1", "follows")
    table = new_table(*heads, left=(0, 6))
    short = short_names(robot.joints)
    for j, joint in enumerate(robot.joints):
        unit = joint_units(robot, joint)["load"]
        shapes = comparison.shapes[joint]
        signal = max(shapes, key=lambda s: shapes[s].share)
        add_row(
            table,
            short[joint],
            with_unit(number(comparison.torque_rms[j]), unit),
            with_unit(number(comparison.rms[j]), unit),
            percent(comparison.relative_rms[j]),
            with_unit(number(comparison.bias[j], 2), unit),
            f"{comparison.autocorrelation[j]:.2f}".replace("-", "−"),
            f"{signal} {percent(shapes[signal].share)}",
        )
    add_row(table, "mean", "", "", percent(comparison.mean_error), "", "", "", style="bold")
    table.caption = (
        "error = model − measured; lag 1: its autocorrelation one sample apart; "
        "follows: the signal whose regions hold most of its variance"
    )
    return table


def where_it_fails(comparison: Comparison, most: int = 10) -> Table:
    """Return the regions in which the residual of a joint is largest beside its own mean, worst first.

    Args:
        comparison: The outcome of ``compare``.
        most: How many regions to list.
    """
    table = new_table("joint", "where", "|residual| there", "bias there", "× its mean", left=(0, 1))
    short = short_names(comparison.model.robot.joints)
    for r in comparison.worst_regions[:most]:
        unit = joint_units(comparison.model.robot, r.joint)["load"]
        add_row(
            table,
            short[r.joint],
            region_words(r),
            with_unit(number(r.rms), unit),
            with_unit(number(r.bias, 2), unit),
            f"{r.ratio:.1f}",
        )
    return table


def check_table(check: LogCheck) -> Table:
    """Return the findings of a check, what needs attention first.

    Args:
        check: The outcome of ``check_log``.
    """
    table = new_table("", "about", "joint", "finding", left=(0, 1, 2, 3))
    rest = [f for f in check.findings if f not in check.problems]
    for f in [*check.problems, *sorted(rest, key=lambda f: f.severity == "ok")]:
        mark, style = MARKS[f.severity]
        said = clean(f.message)
        if f.advice:
            said.append_text(clean(f"\n→ {f.advice}", "italic"))
        label = f"{mark} {f.severity}"
        table.add_row(Text(label, style), clean(f.topic.replace("_", " ")), clean(f.joint or ""), said)
    return table
