"""Explicit conversions of a log's numbers to SI units and to the signs of the URDF."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.logs.timestamps import SECONDS
from cdia_pin.phrases import shortened, some

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

ANGLES = {"rad": 1.0, "deg": np.pi / 180.0}  # [rad] in one of each unit
LENGTHS = {"m": 1.0, "mm": 1e-3}  # [m] in one of each unit
TORQUES = {
    "Nm": 1.0,
    "Nmm": 1e-3,
    "A": 1.0,
    "mA": 1e-3,
}  # [N·m] in one of each unit; drive gains turn A into N·m
CURRENTS = ("A", "mA")  # of them, those that need drive gains
ANOTHER = re.compile(r",(?=\s*\w+\s*=)")  # the comma between two conversions in one text; others part joints


class GravityInEffort(StrEnum):
    """Whether a log's efforts contain the gravity torque."""

    INCLUDED = "included"
    COMPENSATED = "compensated"  # the controller subtracted it; the URDF's gravity is added back


@dataclass(frozen=True, repr=False)
class Conversion:
    """Units and signs of a log that are not SI or not those of the URDF.

    Attributes:
        time: Unit of time, ``s``, ``ms``, ``us`` or ``ns``; inferred if None.
        rate: Rows per second [Hz] of a log whose rows follow at an even pace: then they are counted, and its times, if
            there are any, are not read. As the log's times say if None.
        angle: Unit of revolute positions and velocities, ``rad`` or ``deg``; that of the format if None.
        length: Unit of prismatic positions and velocities, ``m`` or ``mm``.
        torque: Unit of revolute efforts, ``Nm``, ``Nmm``, ``A`` or ``mA`` (currents need drive gains).
        flip_position: Joints whose axis points the other way: position and velocity change sign.
        flip_velocity: Joints of which only the velocity changes sign.
        flip_effort: Joints of which the effort changes sign.
        gravity: ``included`` in the efforts, or ``compensated`` by the controller: then the URDF's gravity is
            added back. As the format says if None.
        reduction: {joint: gear ratio [1]} where the effort is that of the motor before the gear.
        use_velocity: False to ignore recorded velocities; then they are derived from the positions.
    """

    time: str | None = None
    rate: float | None = None
    angle: str | None = None
    length: str = "m"
    torque: str = "Nm"
    gravity: str | None = None
    flip_position: tuple[str, ...] = ()
    flip_velocity: tuple[str, ...] = ()
    flip_effort: tuple[str, ...] = ()
    reduction: Mapping[str, float] = field(default_factory=dict)
    use_velocity: bool = True

    def __post_init__(self) -> None:
        for kind, given, valid in (
            ("unit of time", self.time, SECONDS),
            ("unit of angle", self.angle, ANGLES),
            ("unit of length", self.length, LENGTHS),
            ("unit of torque", self.torque, TORQUES),
            ("gravity", self.gravity, tuple(GravityInEffort)),
        ):
            if given is not None and given not in valid:
                raise LogError("convert: " + unknown_name(kind, str(given), valid))
        if self.rate is not None:
            object.__setattr__(self, "rate", _rate(self.rate))
        for name in ("flip_position", "flip_velocity", "flip_effort"):
            value = getattr(self, name)
            object.__setattr__(self, name, (value,) if isinstance(value, str) else tuple(value))
        bad = {j: r for j, r in self.reduction.items() if not (np.isfinite(r) and r > 0)}
        if bad:
            raise LogError(f"convert: reduction must be a gear ratio above 0, given {bad}")

    def __repr__(self) -> str:
        plain = Conversion()
        changed = [f.name for f in fields(self) if getattr(self, f.name) != getattr(plain, f.name)]
        return f"Conversion({some([f'{n}={shortened(str(getattr(self, n)), 30)}' for n in changed], 3)})"

    @classmethod
    def of(cls, given: Conversion | Mapping[str, Any] | Sequence[str] | None) -> Conversion:
        """Make a conversion from keywords in a dict or from texts ``key=value``.

        Args:
            given: Such as ``{"angle": "deg"}``, ``"angle=deg,torque=mA"`` or ``["angle=deg", "flip_effort=a,b",
                "reduction=elbow_joint:101"]``; None for SI units and the URDF's signs.

        Returns:
            The conversion.

        Raises:
            LogError: If a key, a unit or a number cannot be understood.
        """
        if given is None:
            return cls()
        if isinstance(given, Conversion):
            return given
        texts = given if isinstance(given, Mapping) else _parsed(given)
        known = [f.name for f in fields(cls)]
        for key in texts:
            if key not in known:
                raise LogError("convert: " + unknown_name("key", str(key), known))
        return cls(**dict(texts))

    def check_joints(self, joints: Sequence[str]) -> None:
        """Check that every joint that the conversion names exists.

        Args:
            joints: Joints of the robot.

        Raises:
            LogError: If the robot lacks one of them.
        """
        named = (*self.flip_position, *self.flip_velocity, *self.flip_effort, *self.reduction)
        for joint in named:
            if joint not in joints:
                raise LogError("convert: " + unknown_name("joint", joint, joints))

    def position_scale(self, robot: RobotModel) -> Array:
        """Return the signed factor from the log's positions to SI units.

        Args:
            robot: The robot, which tells the prismatic joints.

        Returns:
            Factor [rad or m per unit of the log], shape (n,).
        """
        scale = np.where(robot.is_prismatic, LENGTHS[self.length], ANGLES[self.angle or "rad"])
        return np.asarray(scale * _signs(robot.joints, self.flip_position))

    def velocity_scale(self, robot: RobotModel) -> Array:
        """Return the signed factor from the log's velocities to SI units.

        Args:
            robot: The robot, which tells the prismatic joints.

        Returns:
            Factor [rad/s or m/s per unit of the log], shape (n,).
        """
        return self.position_scale(robot) * _signs(robot.joints, self.flip_velocity)

    def effort_scale(self, robot: RobotModel) -> Array:
        """Return the signed factor from the log's efforts to SI units, without drive gains.

        Args:
            robot: The robot, which tells the prismatic joints.

        Returns:
            Factor [N·m or N per unit of the log], shape (n,).
        """
        of_current = self.torque in CURRENTS  # a slide's force is in N, its drive's current is a current
        scale = np.where(robot.is_prismatic & (not of_current), 1.0, TORQUES[self.torque])
        gears = np.array([self.reduction.get(j, 1.0) for j in robot.joints])
        return np.asarray(scale * gears * _signs(robot.joints, self.flip_effort))

    def notes(self) -> list[str]:
        """Describe each conversion in one sentence."""
        said = []
        if self.rate is not None:
            said.append(f"rows counted at {self.rate:g} Hz, as asked; times are not read")
        if self.angle not in {None, "rad"}:
            said.append(f"angles converted from {self.angle} to rad, as asked")
        if self.length != "m":
            said.append(f"lengths converted from {self.length} to m, as asked")
        if self.torque == "Nmm":
            said.append("efforts converted from N·mm to N·m, as asked")
        if self.torque == "mA":
            said.append("currents converted from mA to A, as asked")
        for what, joints in (
            ("position and velocity", self.flip_position),
            ("velocity", self.flip_velocity),
            ("effort", self.flip_effort),
        ):
            if joints:
                said.append(f"sign of {what} changed, as asked: {', '.join(joints)}")
        if self.gravity == GravityInEffort.COMPENSATED:
            said.append("the URDF's gravity torque added to the efforts, as asked")
        if self.reduction:
            gears = ", ".join(f"{j} {r:g}" for j, r in self.reduction.items())
            said.append(f"motor-side efforts multiplied by the gear ratio, as asked: {gears}")
        return said


def _signs(joints: Sequence[str], flipped: Sequence[str]) -> Array:
    return np.array([-1.0 if j in flipped else 1.0 for j in joints])


def conversions_in(text: str) -> list[str]:
    """Return the conversions of one text, such as ``angle=deg,torque=mA``, as one text ``key=value`` each.

    Args:
        text: One conversion or several.
    """
    return ANOTHER.split(text)


def _parsed(texts: Sequence[str]) -> dict[str, Any]:
    if isinstance(texts, str):
        texts = [texts]
    out: dict[str, Any] = {}
    for text in (option for given in texts for option in conversions_in(given)):
        key, equals, value = text.partition("=")
        key, value = key.strip(), value.strip()
        if not equals or not value:
            raise LogError(f"convert: '{text}' is not of the form key=value, such as angle=deg")
        if key.startswith("flip_"):
            out[key] = (*out.get(key, ()), *(j.strip() for j in value.split(",")))
        elif key == "reduction":
            out[key] = {**out.get(key, {}), **_ratios(value)}
        elif key == "use_velocity":
            out[key] = value.lower() not in {"false", "no", "0"}
        else:
            out[key] = value
    return out


def _rate(given: Any) -> float:
    try:
        rate = float(given)
    except (TypeError, ValueError):
        rate = np.nan
    if not 0.0 < rate < np.inf:
        raise LogError(f"convert: rate must be a number above 0 [Hz], given {given}")
    return rate


def _ratios(text: str) -> dict[str, float]:
    out = {}
    for part in text.split(","):
        joint, _, ratio = part.partition(":")
        try:
            out[joint.strip()] = float(ratio)
        except ValueError:
            raise LogError(
                f"convert: '{part}' is not of the form joint:ratio, such as elbow_joint:101"
            ) from None
    return out
