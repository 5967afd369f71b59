"""Claims: a figure measured on outcomes, beside what was asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isnan, nan
from statistics import median
from typing import Any

from cdia_pin.viewers.words import percent


@dataclass(frozen=True)
class Figure:
    """A measured figure.

    Attributes:
        value: The figure; NaN where there is nothing to measure.
        n: Number of cases, faults or minutes that it is of.
        text: As it is printed.
    """

    value: float
    n: int
    text: str


Measure = Callable[[Sequence[Any]], Figure]  # from outcomes
Test = Callable[[Any], bool]  # of an outcome


def met(holds: bool) -> str:
    """Return whether a claim holds, in a word."""
    return "yes" if holds else "**NOT met**"


@dataclass(frozen=True)
class Claim:
    """One row of the results.

    Attributes:
        text: What is measured.
        target: What was asked for; empty if nothing was.
        measure: From outcomes to the figure.
        met: Whether a figure is what was asked for.
    """

    text: str
    target: str
    measure: Measure
    met: Callable[[float], bool] = lambda _: True

    def says(self, value: float) -> str:
        """Return whether a figure meets the target, in a word."""
        if not self.target or isnan(value):
            return "–"
        return met(self.met(value))


@dataclass(frozen=True)
class Part:
    """Rows about the same outcomes.

    Attributes:
        title: Of the table.
        about: What it is measured on.
        chosen: Whether an outcome belongs to it.
        claims: Its rows.
    """

    title: str
    about: str
    chosen: Test
    claims: tuple[Claim, ...]


def counted(asked: Sequence[bool]) -> Figure:
    """Return the share of what is true."""
    if not asked:
        return Figure(nan, 0, "–")
    share = sum(asked) / len(asked)
    return Figure(share, len(asked), f"{percent(share)} ({sum(asked)}/{len(asked)})")


def median_of(shares: Sequence[float]) -> Figure:
    """Return the median of some shares."""
    return Figure(median(shares), len(shares), percent(median(shares))) if shares else Figure(nan, 0, "–")


def of_cases(good: Test, of: Test = lambda _: True) -> Measure:
    """Return a measure: the share of cases that are good."""
    return lambda outcomes: counted([good(o) for o in outcomes if of(o)])


def at_least(share: float) -> Callable[[float], bool]:
    """Return a test of a figure."""
    return lambda value: value >= share


def at_most(most: float) -> Callable[[float], bool]:
    """Return a test of a figure."""
    return lambda value: value <= most
