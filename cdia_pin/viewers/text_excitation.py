"""A designed motion in the terminal: its peaks beside the limits, and what it makes identifiable."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.table import Table

from cdia_pin.viewers.cells import add_row, new_table
from cdia_pin.viewers.words import joint_units, listed, number, short_names

if TYPE_CHECKING:
    from cdia_pin.excitation import Excitation

SIGNALS = ("velocity", "acceleration", "effort")


def limits_table(motion: Excitation) -> Table:
    """Return the peak of each signal beside what it was allowed to be, by joint.

    Args:
        motion: The outcome of ``excite``.
    """
    heads = ("joint", "position", "allowed", "speed", "acceleration", "effort")
    table = new_table(*heads, left=(0,))
    peaks, limits, short = motion.peaks(), motion.limits, short_names(motion.joints)
    for j, joint in enumerate(motion.joints):
        add_row(
            table,
            short[joint],
            f"{_fixed(peaks['lower'][j])} to {_fixed(peaks['upper'][j])}",
            f"{_fixed(limits.lower[j])} to {_fixed(limits.upper[j])}",
            *(f"{number(peaks[s][j])} / {_limit(getattr(limits, s)[j])}" for s in SIGNALS),
        )
    units = dict.fromkeys(
        ", ".join(joint_units(motion.robot, j)[s] for s in ("position", *SIGNALS[:2], "load"))
        for j in motion.joints
    )
    start = ", ".join(_fixed(x) for x in motion.position[0])
    peak = f"Peak / limit, in {' or '.join(units)}."
    table.caption = f"{peak} Starts and ends at rest at {start}. {_contacts(motion)}"
    return table


def _contacts(motion: Excitation) -> str:
    if not motion.checked:
        return "The URDF has no collision shapes: contacts were not checked."
    floor = "" if motion.floor is None else f", with a floor at {_fixed(motion.floor)} m"
    return (
        f"Links stay {1000 * motion.clearance:g} mm apart ({motion.checked} pairs of shapes{floor}); other obstacles "
        "are not known."
    )


def gain_words(motion: Excitation) -> str:
    """Return what a motion gains, in a sentence or two.

    Args:
        motion: The outcome of ``excite``.
    """
    gain = motion.gain
    if not gain.between:
        seen, count = gain.seen
        return (
            f"Motions identify {seen} combinations of {count} parameters; their standard deviations are "
            f"{number(gain.after)} times smaller than {gain.beside} (geometric mean)."
        )
    one, two = gain.between
    said = (
        f"{one} and {two} differ by {number(gain.after)} standard deviations; {gain.beside}: "
        f"{number(gain.before)}."
    )
    contained = [b for b, seen in zip(gain.between, gain.separable, strict=True) if not seen]
    if contained:
        (other,) = (b for b in gain.between if b not in contained)
        inner = listed(contained)
        said += f" Only what {other} has beyond {inner} is identifiable: {other} contains {inner}."
    return (
        said
        if gain.enough
        else f"{said} This is too little for a sure decision: allow more time or wider limits."
    )


def _limit(value: float) -> str:
    return number(value) if math.isfinite(value) else "–"


def _fixed(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}".replace("-", "−")
