"""An identification in the terminal: errors by joint, friction and rotors, base parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table

from cdia_pin.effects.body import Body
from cdia_pin.regression.shares import mean_share
from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.parameter_rows import parameters, shape_parameters
from cdia_pin.viewers.words import (
    course_words,
    effect_name,
    joint_units,
    listed,
    number,
    percent,
    short_names,
    with_interval,
    with_unit,
)

if TYPE_CHECKING:
    from cdia_pin.identification import Identification

SHOWN = 12  # base parameters, unless all are asked for


def identification_table(found: Identification, *, everything: bool = False) -> RenderableType:
    """Return errors before and after, friction and rotors, base parameters, and what keeps the values of the URDF.

    Args:
        found: The outcome of ``identify``.
        everything: Whether all base parameters are listed, or those that are furthest from the URDF.
    """
    said = [Padding(clean(s, "bold" if k == 0 else ""), (0, 1)) for k, s in enumerate(sentences(found))]
    return Group(_errors(found), _joints(found), _base(found, everything), *said)


def sentences(found: Identification) -> list[str]:
    """Return what an identification means, in sentences.

    Args:
        found: The outcome of ``identify``.
    """
    before, after = (
        mean_share(e, found.heldout_torque_rms) for e in (found.heldout_before, found.heldout_after)
    )
    base, names = found.base, short_names(found.model.robot.joints)
    silent = [n for n, seen in zip(base.names, base.identifiable, strict=True) if not seen]
    links = [names[j] for j in found.model.robot.joints if any(n.startswith(f"{j}.") for n in silent)]
    out = [
        f"On data that was not fitted the error {course_words(before, after)} of the torque, mean over the "
        "joints.",
        "Every link is physically consistent."
        if (found.margin >= 0).all()
        else "Not every link is physically consistent: do not simulate with these numbers.",
    ]
    if silent:
        out.append(
            f"The motion identifies {len(base) - len(silent)} of {len(base)} base parameters; the others, of "
            f"{listed(links)}, keep the values of the URDF. A motion from cdia excite would identify more."
        )
    return out


def _errors(found: Identification) -> Table:
    robot = found.model.robot
    table = new_table(
        "joint", "torque RMS", "fitted: URDF", "identified", "held out: URDF", "identified", left=(0,)
    )
    columns = (
        (found.rms_before, found.torque_rms),
        (found.rms_after, found.torque_rms),
        (found.heldout_before, found.heldout_torque_rms),
        (found.heldout_after, found.heldout_torque_rms),
    )
    for j, (joint, name) in enumerate(short_names(robot.joints).items()):
        torque = with_unit(number(found.torque_rms[j]), joint_units(robot, joint)["load"])
        shares = (mean_share(error[j : j + 1], over[j : j + 1]) for error, over in columns)
        shown = (percent(s) if over[j] > 0 else "–" for s, (_, over) in zip(shares, columns, strict=True))
        add_row(table, name, torque, *shown)
    add_row(table, "mean", "", *(percent(mean_share(*c)) for c in columns), style="bold")
    return table


def _joints(found: Identification) -> Table:
    robot = found.model.robot
    table = new_table("joint", "what acts in it, ± 95 %", left=(0, 1))
    for joint, name in short_names(robot.joints).items():
        rows = []
        for term in found.model.terms:
            if term.effect.scope[:1] == (joint,) and not isinstance(term.effect, Body):
                numbers = [*parameters(term, robot), *shape_parameters(term, robot)]
                values = ", ".join(
                    p["text"] if len(numbers) == 1 else f"{p['name']} {p['text']}" for p in numbers
                )
                rows.append(f"{effect_name(term.effect)} {values}")
        table.add_row(clean(name, "bold"), clean("\n".join(rows)))
    return table


def _base(found: Identification, everything: bool) -> Table:
    base = found.base
    table = new_table("base parameter", "URDF", "identified ± 95 %", "identifiable", left=(0,))
    furthest = np.argsort(-base.moved)
    order = np.arange(len(base)) if everything else furthest[base.identifiable[furthest]][:SHOWN]
    for k in order:
        unit, value, half = base.units[k], float(base.value[k]), float(base.half_width[k])
        grouped = f" + {base.grouped[k]} more" if base.grouped[k] else ""
        add_row(
            table,
            base.names[k] + grouped,
            with_unit(number(float(base.urdf[k])), unit),
            with_interval(value, (value - half, value + half), unit),
            "yes" if base.identifiable[k] else "no",
        )
    if not everything:
        table.caption = (
            f"the {len(order)} identifiable ones furthest from the URDF; --all shows all {len(base)}"
        )
    return table
