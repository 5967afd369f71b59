"""Small pictures within a line of a table: SVG that needs no script, in colours that suit light and dark."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.viewers.report_series import extremes

Array = NDArray[np.float64]

BEFORE, AFTER, FLOOR = "#d55e00", "#2b8fd6", "#8a949e"
POINTS = 160  # of a line


def bar(shares: Sequence[float], colours: Sequence[str], largest: float, words: str) -> str:
    """Return bars under each other, each a share of the largest."""
    each = 12 / len(shares)
    parts = "".join(
        f'<rect y="{1 + k * each:.1f}" width="{max(150 * s / (largest or 1.0), 1.5):.1f}" height="{each - 1:.1f}" '
        f'rx="1.5" fill="{c}"/>'
        for k, (s, c) in enumerate(zip(shares, colours, strict=True))
    )
    return _svg(150, 14, parts, words)


def line(signals: Sequence[Array], colours: Sequence[str], words: str) -> str:
    """Return signals over the same time, on one scale around zero."""
    most = max((float(np.abs(s).max()) for s in signals if len(s)), default=0.0) or 1.0
    paths = [f'<path d="M0 14H180" stroke="{FLOOR}" stroke-width="0.6" opacity="0.7"/>']
    for signal, colour in zip(signals, colours, strict=True):
        keep = extremes([signal], POINTS)
        x, y = 180.0 * keep / max(len(signal) - 1, 1), 14.0 - 13.0 * signal[keep] / most
        at = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        paths.append(f'<polyline points="{at}" fill="none" stroke="{colour}" stroke-width="1.1"/>')
    return _svg(180, 28, "".join(paths), words)


def fall(fitted: Sequence[float], heldout: Sequence[float], floor: float, words: str) -> str:
    """Return errors, step by step, and the floor under them."""
    top = max(*fitted, *heldout, floor) or 1.0
    x = np.linspace(8, 252, max(len(fitted), 2))[: len(fitted)]

    def level(v: Sequence[float]) -> Array:
        return 78.0 - 70.0 * np.asarray(v) / top

    base = float(level([floor])[0])
    parts = [f'<path d="M0 {base:.1f}H260" stroke="{FLOOR}" stroke-dasharray="2 3"/>']
    for values, colour, dash in ((heldout, BEFORE, ' stroke-dasharray="5 4"'), (fitted, AFTER, "")):
        y = level(values)
        at = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        parts.append(f'<polyline points="{at}" fill="none" stroke="{colour}" stroke-width="1.8"{dash}/>')
        parts += [
            f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{colour}"/>' for a, b in zip(x, y, strict=True)
        ]
    return _svg(260, 86, "".join(parts), words)


def strip(spans: Sequence[tuple[float, float, str, float]], begin: float, end: float, words: str) -> str:
    """Return stretches of time, [from, to, colour, opacity] each."""
    scale = 320 / ((end - begin) or 1.0)
    parts = "".join(
        f'<rect x="{(a - begin) * scale:.1f}" width="{max((b - a) * scale, 1):.1f}" height="14" fill="{colour}" '
        f'opacity="{opacity}"/>'
        for a, b, colour, opacity in spans
    )
    return _svg(320, 14, parts, words)


def _svg(width: int, height: int, parts: str, words: str) -> str:
    return (
        f'<svg role="img" aria-label="{html.escape(words)}" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}"><title>{html.escape(words)}</title>{parts}</svg>'
    )
