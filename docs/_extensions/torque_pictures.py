"""The picture of an effect: its torque along the standard motion, as SVG that takes its colours from the page."""

from __future__ import annotations

import io
import re

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from standard_motion import motion_for

from cdia_pin.effects import Signal, State, Term

matplotlib.use("svg")

INK, FAINT = "#010203", "#040506"  # stand-ins, which become the colours of the page
TORQUE = "#2b83ba"  # seen on white as on black
STYLE = {
    "font.size": 8.5,
    "svg.fonttype": "none",  # the browser's own letters
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
}


def picture(term: Term) -> str:
    """Return the torque of a term over time, and over the signal on which it depends, as an SVG element.

    Args:
        term: The effect with its numbers.
    """
    x = motion_for(term.effect)
    torque = term.torque(x)
    j = joint_shown(term, torque, x)
    label, signal = cause(term, x, j)
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": term.label}):
        figure = Figure(figsize=(7.2, 2.2), layout="constrained")
        over_time, over_cause = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        beside = over_time.twinx()
        beside.plot(x.time, x.v[:, j], color=FAINT, linewidth=0.8)
        beside.set_axis_off()
        over_time.plot(x.time, torque[:, j], color=TORQUE, linewidth=1.4)
        over_time.set(xlabel="time [s]", ylabel=f"f on {x.robot.joints[j].removesuffix('_joint')} [N·m]")
        over_cause.plot(signal, torque[:, j], color=TORQUE, linewidth=1.0)
        over_cause.set(xlabel=label)
        for axes in (over_time, over_cause):
            axes.axhline(0.0, color=FAINT, linewidth=0.6)
        return inline(figure)


def joint_shown(term: Term, torque: np.ndarray, x: State) -> int:
    """Return the index of the effect's own joint, or of the one that feels most of it."""
    if len(term.effect.acts_on(x.robot)) == 1:
        return term.effect.acts_on(x.robot)[0]
    return int(np.argmax(np.sqrt(np.mean(torque**2, axis=0))))


def cause(term: Term, x: State, j: int) -> tuple[str, np.ndarray]:
    """Return name and values of the signal of the joint that explains the torque best to a reader."""
    signals = term.effect.traits.depends_on
    if Signal.TORQUE in signals:
        return "τ [N·m]", x.effort[:, j]
    if signals == {Signal.ACCELERATION}:
        return "q̈ [rad/s²]", x.a[:, j]
    if signals & {Signal.VELOCITY, Signal.DIRECTION} and Signal.POSITION not in signals:
        return "q̇ [rad/s]", x.v[:, j]
    return "q [rad]", x.q[:, j]


def inline(figure: Figure) -> str:
    """Return a figure as an SVG element that scales with the page and takes its colours."""
    file = io.StringIO()
    figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    text = file.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text))
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    return text.replace(INK, "currentColor").replace(FAINT, "var(--color-foreground-border, #999)")
