"""A calibration of drive gains in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rich.console import Group, RenderableType
from rich.padding import Padding

from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.words import listed, number, short_names, with_interval

if TYPE_CHECKING:
    from cdia_pin.identification import GainCalibration

Array = NDArray[np.float64]


def calibration_table(found: GainCalibration, nominal: Array | None) -> RenderableType:
    """Return the scale of each joint, with the arm's own weight beside it as a first check.

    Args:
        found: The calibration.
        nominal: Gains with which the logs were read [N·m/A], shape (n,); None where they hold torques.
    """
    head = ("nominal", "calibrated, N·m/A") if nominal is not None else ()
    table = new_table("joint", *head, "scale", "by URDF", "known by", left=(0,))
    table.caption = (
        "scale: true over stated torque, ± 95 %; by URDF: what the arm's own weight asks for, a first check"
    )
    names = short_names(found.joints)
    for j, joint in enumerate(found.joints):
        scale, half = float(found.scale[j]), float(found.tolerance[j])
        cells = []
        if nominal is not None:
            value = nominal[j] * scale
            interval = (value - nominal[j] * half, value + nominal[j] * half)
            cells = [number(float(nominal[j])), with_interval(float(value), interval, "")]
        weight = found.by_own_weight.get(joint)
        add_row(
            table,
            names[joint],
            *cells,
            with_interval(scale, (scale - half, scale + half), ""),
            number(weight) if weight else "",
            "payload" if found.determined[j] else "other joints",
        )
    centre = ", ".join(number(float(c)) for c in found.centre)
    said = [f"The payload of {number(found.mass)} kg has its centre of mass at {centre} m in the tool frame."]
    vague = [names[j] for j, known in zip(found.joints, found.determined, strict=True) if not known]
    if vague:
        said.append(f"The payload hardly loads {listed(vague)}: what they have is common to all joints.")
    if nominal is None:
        said.append(
            "The logs hold torques: read them with --convert torque=A and --gains to apply the scales."
        )
    return Group(table, *(Padding(clean(s), (0, 1)) for s in said))
