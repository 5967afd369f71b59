"""The chart of a course, as a picture of lines in the page itself: values with intervals, fit, and change."""

from __future__ import annotations

import html
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet import CourseTrend
from cdia_pin.viewers.words import number

Array = NDArray[np.float64]

WIDTH, HEIGHT = 960.0, 220.0  # of the drawing, in its own units
LEFT, RIGHT, TOP, BOTTOM = 74.0, 12.0, 12.0, 30.0  # margins
TICKS = 4  # on each axis, about
CHART_STYLE = """
.trend { width: 100%; height: auto; display: block; }
.trend text { fill: var(--soft); font-size: 12px; }
.trend .grid { stroke: var(--line); stroke-width: 1; }
.trend .interval { stroke: var(--before); stroke-width: 1.2; opacity: .55; }
.trend .value { fill: var(--before); }
.trend .left { fill: none; stroke: var(--soft); }
.trend .fit { fill: none; stroke: var(--after); stroke-width: 2; }
.trend .since { stroke: var(--warn); stroke-width: 1.5; stroke-dasharray: 5 4; }
"""


def course_chart(trend: CourseTrend) -> str:
    """Return the chart of a course as SVG.

    Args:
        trend: The course with its trend.
    """
    course, at = trend.course, trend.compared
    if not len(at):
        return "<p class='soft'>no comparable log</p>"
    x = _times(course.recorded)
    shown = np.isfinite(course.value)
    room = 1.1 * 2 * course.deviation[at]  # two standard deviations, and a little
    low, high = float(np.min(course.value[at] - room)), float(np.max(course.value[at] + room))
    low, high = (low, high) if high > low else (low - 1.0, high + 1.0)
    span = max(float(x[-1] - x[0]), 1e-9)

    def across(value: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * (value - float(x[0])) / span

    def up(value: float) -> float:
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (value - low) / (high - low)

    parts = []
    for tick in _round_ticks(low, high):
        parts.append(_line("grid", LEFT, up(tick), WIDTH - RIGHT, up(tick)))
        parts.append(_label(LEFT - 8, up(tick) + 4, "end", number(tick)))
    for k in np.unique(np.linspace(0, len(x) - 1, TICKS + 1).astype(int)).tolist():
        anchor = "start" if k == 0 else "end" if k == len(x) - 1 else "middle"
        parts.append(_label(across(x[k]), HEIGHT - 8, anchor, _date(course.recorded[k], k)))
    for k in np.flatnonzero(shown).tolist():
        here, value, half = across(x[k]), float(course.value[k]), 2 * float(course.deviation[k])
        if course.use[k]:
            parts.append(_line("interval", here, up(value - half), here, up(value + half)))
            parts.append(_dot("value", here, up(value)))
        elif low <= value <= high:
            parts.append(_dot("left", here, up(value)))
    if trend.is_judged:
        line = " ".join(f"{across(x[k]):.1f},{up(f):.1f}" for k, f in zip(at, trend.fitted, strict=True))
        parts.append(f"<polyline class='fit' points='{line}'/>")
    if trend.alarm is not None:
        here = across(x[course.logs.index(trend.alarm.since)])
        parts.append(_line("since", here, TOP, here, HEIGHT - BOTTOM))
    parts.append(_label(4, TOP + 8, "start", "" if course.unit == "1" else course.unit))
    label = html.escape(f"{course.label} [{course.unit}]", quote=True)
    head = f"<svg class='trend' viewBox='0 0 {WIDTH:g} {HEIGHT:g}' role='img' aria-label='{label}'>"
    return f"{head}{''.join(parts)}</svg>"


def _line(kind: str, x1: float, y1: float, x2: float, y2: float) -> str:
    return f"<line class='{kind}' x1='{x1:.1f}' y1='{y1:.1f}' x2='{x2:.1f}' y2='{y2:.1f}'/>"


def _dot(kind: str, x: float, y: float) -> str:
    return f"<circle class='{kind}' cx='{x:.1f}' cy='{y:.1f}' r='2.6'/>"


def _label(x: float, y: float, anchor: str, text: str) -> str:
    return f"<text x='{x:.1f}' y='{y:.1f}' text-anchor='{anchor}'>{html.escape(text)}</text>"


def _times(recorded: tuple[datetime | None, ...]) -> Array:
    """Return the times [s]; the numbers of the logs where one has no time."""
    if any(at is None for at in recorded):
        return np.arange(len(recorded), dtype=float)
    return np.array([at.timestamp() for at in recorded if at is not None])


def _date(at: datetime | None, index: int) -> str:
    return f"log {index + 1}" if at is None else f"{at:%Y-%m-%d}"


def _round_ticks(low: float, high: float) -> Array:
    """Return round numbers between two ends."""
    rough = (high - low) / TICKS
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * min((f for f in (1.0, 2.0, 5.0, 10.0) if f * power >= rough), default=10.0)
    return np.asarray(np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step + 0.0)
