"""Curves as a picture in a page: shares over rates, drawn as SVG."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite

from cdia_pin.viewers.words import number

WIDTH, HEIGHT = 720, 320  # [px]
LEFT, RIGHT, TOP, BOTTOM = 56, 16, 14, 46  # [px], margins
COLOURS = ("#2f6fde", "#c2571a", "#2f8f5b", "#8a4fc7", "#b23a5b", "#5b6472")
TICKS = 4  # intervals of an axis

Place = Callable[[float, float], tuple[float, float]]  # from a rate and a share to the picture [px]


@dataclass(frozen=True)
class Curve:
    """A curve.

    Attributes:
        name: What it belongs to.
        points: Rate and share of each point.
        now: Number of the point that is marked.
    """

    name: str
    points: tuple[tuple[float, float], ...]
    now: int


def curve_picture(curves: Sequence[Curve], across: str, up: str) -> str:
    """Return curves as a picture; empty if there is nothing to draw.

    Args:
        curves: The curves.
        across: Title of the horizontal axis.
        up: Title of the vertical axis, a share.
    """
    drawn = [c for c in curves if c.points and all(isfinite(x) and isfinite(y) for x, y in c.points)]
    if not drawn:
        return "<p class='soft'>Nothing to draw: there are no faults, or there is no time without one.</p>"
    most = max(max(x for x, _ in c.points) for c in drawn) or 1.0

    def place(x: float, y: float) -> tuple[float, float]:
        return (
            LEFT + (WIDTH - LEFT - RIGHT) * x / most,
            HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * y,
        )

    parts = [*_axes(place, most, across, up)]
    for k, curve in enumerate(drawn):
        colour = COLOURS[k % len(COLOURS)]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*p) for p in curve.points))
        x, y = place(*curve.points[curve.now])
        parts += [
            f"<polyline points='{line}' fill='none' stroke='{colour}' stroke-width='2'/>",
            f"<circle cx='{x:.1f}' cy='{y:.1f}' r='5' fill='none' stroke='{colour}' stroke-width='2'/>",
            f"<text x='{WIDTH - RIGHT}' y='{HEIGHT - BOTTOM - 12 - 16 * k}' text-anchor='end' fill='{colour}'>"
            f"{html.escape(curve.name)}</text>",
        ]
    return (
        f"<figure class='card'><svg viewBox='0 0 {WIDTH} {HEIGHT}' role='img' font-size='12' "
        f"aria-label='{html.escape(up)} over {html.escape(across)}' style='width:100%;height:auto'>"
        f"{''.join(parts)}</svg></figure>"
    )


def _axes(place: Place, most: float, across: str, up: str) -> list[str]:
    out = []
    for k in range(TICKS + 1):
        x, bottom = place(most * k / TICKS, 0.0)
        left, y = place(0.0, k / TICKS)
        out += [
            f"<line x1='{x:.1f}' x2='{x:.1f}' y1='{TOP}' y2='{bottom:.1f}' stroke='currentColor' opacity='.15'/>",
            f"<line x1='{left:.1f}' x2='{WIDTH - RIGHT}' y1='{y:.1f}' y2='{y:.1f}' stroke='currentColor' "
            "opacity='.15'/>",
            f"<text x='{x:.1f}' y='{bottom + 16:.1f}' text-anchor='middle' fill='currentColor'>"
            f"{number(most * k / TICKS, 2)}</text>",
            f"<text x='{left - 6:.1f}' y='{y + 4:.1f}' text-anchor='end' fill='currentColor'>"
            f"{100 * k / TICKS:.0f} %</text>",
        ]
    middle = (LEFT + WIDTH - RIGHT) / 2
    out.append(
        f"<text x='{middle:.0f}' y='{HEIGHT - 8}' text-anchor='middle' fill='currentColor'>{html.escape(across)}</text>"
    )
    out.append(
        f"<text x='14' y='{HEIGHT / 2:.0f}' text-anchor='middle' fill='currentColor' "
        f"transform='rotate(-90 14 {HEIGHT / 2:.0f})'>{html.escape(up)}</text>"
    )
    return out
