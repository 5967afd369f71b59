"""A row of the table of what must be shown."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.claims import Claim, Figure
from benchmarks.markdown import Row


def row(text: str, target: str, figure: Figure, met: Callable[[float], bool]) -> Row:
    """Return a claim with its target, what was measured, of how many, and whether it is met.

    Args:
        text: What is measured.
        target: What was asked for.
        figure: What was measured.
        met: Whether a figure is what was asked for.
    """
    return (
        text,
        target,
        figure.text,
        figure.n,
        Claim(text, target, lambda _: figure, met).says(figure.value),
    )
