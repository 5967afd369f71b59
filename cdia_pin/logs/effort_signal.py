"""The effort of a log: a torque as recorded, or currents times drive gains, with what is known of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.conversion import CURRENTS, Conversion, GravityInEffort
from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.gains import DriveGains
from cdia_pin.logs.signal_picker import SignalPicker
from cdia_pin.logs.torque_side import BEHIND_THE_GEAR, TorqueSide

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PickedEffort:
    """The efforts of a log before the conversion of their unit and sign.

    Attributes:
        values: Efforts in the unit of the log, or N·m from currents, shape (N, n).
        side: Side of the gear on which they were measured.
        side_of_format: Whether the format alone says that they were measured behind the gear.
        origin: Whether they were measured.
        without_gravity: Whether the URDF's gravity has to be added.
        tolerance: Tolerance of drive gains [1], shape (n,); None without gains.
    """

    values: Array
    side: TorqueSide
    origin: EffortOrigin
    without_gravity: bool
    tolerance: Array | None = None
    side_of_format: bool = False


def pick_effort(
    pick: SignalPicker, gains: DriveGains | None, conversion: Conversion, side: TorqueSide
) -> PickedEffort:
    """Pick the efforts of a log.

    A torque that was measured is used before currents. Currents with drive gains are used before a torque without
    gravity, because they show masses.

    Args:
        pick: The columns of the log; notes are added to it.
        gains: Drive gains; None if nobody gave any.
        conversion: What the user says of units and gravity.
        side: Side of the gear that the user states; unknown if he does not.

    Raises:
        LogError: If the log has neither, currents lack gains, or nothing was measured.
    """
    signal = _signal(pick, gains)
    facts = pick.choice.facts(signal)
    values = pick.required(signal)
    _require_measured(values, signal, pick)
    tolerance = None
    if signal == "current" or conversion.torque in CURRENTS:
        values, tolerance = _torques(values, gains, pick)
    elif gains is not None:
        pick.notes.append("drive gains not used: the log has efforts (--convert torque=A applies them)")
    known = facts
    if conversion.gravity is not None:  # the user knows better than the format
        known = replace(facts, without_gravity=conversion.gravity == GravityInEffort.COMPENSATED)
    if facts.caveat and known.without_gravity == facts.without_gravity:
        pick.notes.append(facts.caveat)
    implied = facts.side if tolerance is None else TorqueSide.MOTOR
    asked, side = side, side if side is not TorqueSide.UNKNOWN else implied
    if side is TorqueSide.LINK:
        said = (
            "as asked"
            if asked is TorqueSide.LINK
            else f"as format '{pick.choice.format.name}' records it, unless the torque shows much of it "
            "(--torque-side motor or link decides)"
        )
        pick.notes.append(f"{BEHIND_THE_GEAR}, {said}")
    by_format = side is TorqueSide.LINK and asked is not TorqueSide.LINK
    return PickedEffort(values, side, known.origin, known.without_gravity, tolerance, by_format)


def _signal(pick: SignalPicker, gains: DriveGains | None) -> str:
    """Return ``effort`` or ``current``."""
    if not pick.columns.labels("current"):
        return "effort"
    if not pick.columns.labels("effort"):
        return "current"
    measured = pick.choice.facts("effort").origin is EffortOrigin.MEASURED
    used = "effort" if measured or gains is None else "current"
    pick.notes.append(f"the log has both effort and current; the {used} is used")
    return used


def _require_measured(values: Array, signal: str, pick: SignalPicker) -> None:
    """Refuse efforts that nobody measured: zero, or not a number, throughout."""
    advice = f"; {pick.choice.format.advice}" if pick.choice.format.advice else ""
    if np.isnan(values).all():
        raise LogError(
            f"{pick.source}: {signal} is empty (NaN throughout), so nothing can be compared{advice}"
        )
    if not values.any():
        raise LogError(f"{pick.source}: {signal} is zero throughout, so nothing was measured{advice}")


def _torques(current: Array, gains: DriveGains | None, pick: SignalPicker) -> tuple[Array, Array]:
    """Return currents times drive gains [N·m], shape (N, n), and the tolerance of the gains [1], shape (n,)."""
    if gains is None:
        example = ", ".join(f'"{j}": 10.0' for j in pick.joints[:2])
        raise LogError(
            f"{pick.source}: the log has motor currents [A]; give drive gains [N·m/A] per joint with "
            f"--gains gains.json (in Python gains=), holding {{{example}, …}}"
        )
    rows = zip(pick.joints, gains.value, gains.relative_tolerance, strict=True)
    said = ", ".join(f"{j} {k:g} ± {share:.2g} %" for j, k, share in ((j, k, 100 * r) for j, k, r in rows))
    pick.notes.append(
        f"effort is current times drive gain [N·m/A] and no more accurate than these gains: {said}"
    )
    return current * gains.value, gains.relative_tolerance
