"""The dialogue on columns of unknown names: asked in a terminal, never in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace

import typer

from cdia_pin.cli.console import paused
from cdia_pin.logs.formats.guess import ColumnGuess, options_of, reading_of
from cdia_pin.robot import RobotModel

ASKED = ("time", "position", "velocity", "effort", "current")  # in this order
NONE = "-"  # the answer for a signal that the log lacks


def can_ask() -> bool:
    """Return whether a person sits at both ends: a terminal for the questions and for the answers."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def asked_columns(source: str, guesses: Sequence[ColumnGuess], robot: RobotModel) -> dict[str, str]:
    """Show the columns of a log with a guess of each, and ask which hold what.

    Args:
        source: Name of the log.
        guesses: What its columns may hold.
        robot: The arm.

    Returns:
        Values of ``columns``, ``convert`` and ``joint_map``; the options to type next time are printed.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    table = Table("columns", "from", "to", "looks like", title=Text(f"columns of {source}"), box=SIMPLE_HEAD)
    for guess in guesses:
        table.add_row(
            Text(guess.pattern), f"{guess.lowest:.3g}", f"{guess.highest:.3g}", Text(guess.said_short)
        )
    with paused() as console:
        console.print(table)
        console.print(
            f"# is the number of a joint, * its name; {NONE}: the log has none. Enter takes what stands in brackets."
        )
        answers = []
        for signal in ASKED:
            known = next((g for g in guesses if g.signal == signal), None)
            if known is None and signal in {"time", "current"}:
                continue
            answer = str(typer.prompt(signal, default=known.pattern if known else NONE, err=True)).strip()
            if answer != NONE:
                like = next(
                    (g for g in guesses if g.pattern == answer), ColumnGuess(answer, signal, 0.0, 0.0, "")
                )
                answers.append(replace(like, signal=signal))
        if answers:
            console.print(f"next time: {options_of(answers, robot)}", markup=False, soft_wrap=True)
    return reading_of(answers, robot)
