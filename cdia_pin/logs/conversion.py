"""Explicit conversions from what a log holds to SI units and the URDF's signs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.logs.timestamps import SECONDS

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

ANGLES = {"rad": 1.0, "deg": np.pi / 180.0}  # [rad]
LENGTHS = {"m": 1.0, "mm": 1e-3}  # [m]
TORQUES = {"Nm": 1.0, "Nmm": 1e-3, "A": 1.0}  # [N·m]; A becomes N·m through the drive gains


@dataclass(frozen=True)
class Conversion:
    """What a log's numbers mean where they are not SI or not in the URDF's sense.

    Attributes:
        time: Unit of time, ``s``, ``ms``, ``us`` or ``ns``; inferred if None.
        angle: Unit of revolute positions and velocities, ``rad`` or ``deg``.
        length: Unit of prismatic positions and velocities, ``m`` or ``mm``.
        torque: Unit of revolute efforts, ``Nm``, ``Nmm`` or ``A`` (then drive gains are needed).
        flip_position: Joints whose axis points the other way: position and velocity change sign.
        flip_velocity: Joints of which only the velocity changes sign.
        flip_effort: Joints of which the effort changes sign.
        gravity: ``included`` in the efforts, or ``compensated``: the controller took it out, and the
            URDF's gravity is added back.
        reduction: {joint: gear ratio} where the effort is that of the motor before the gear.
        use_velocity: False to leave recorded velocities out; they are derived from positions then.
    """

    time: str | None = None
    angle: str = "rad"
    length: str = "m"
    torque: str = "Nm"
    gravity: str = "included"
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
            ("gravity", self.gravity, ("included", "compensated")),
        ):
            if given is not None and given not in valid:
                raise LogError("convert: " + unknown_name(kind, str(given), valid))
        for name in ("flip_position", "flip_velocity", "flip_effort"):
            value = getattr(self, name)
            object.__setattr__(self, name, (value,) if isinstance(value, str) else tuple(value))
        bad = {j: r for j, r in self.reduction.items() if not (np.isfinite(r) and r > 0)}
        if bad:
            raise LogError(f"convert: reduction must be a gear ratio above 0, given {bad}")

    @classmethod
    def of(cls, given: Conversion | Mapping[str, Any] | Sequence[str] | None) -> Conversion:
        """Make a conversion from keywords in a dict or from texts ``key=value``.

        Args:
            given: For instance ``{"angle": "deg"}`` or ``["angle=deg", "flip_effort=a,b",
                "reduction=elbow_joint:101"]``.

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
        """Raise LogError where a joint is named that the robot does not have."""
        named = (*self.flip_position, *self.flip_velocity, *self.flip_effort, *self.reduction)
        for joint in named:
            if joint not in joints:
                raise LogError("convert: " + unknown_name("joint", joint, joints))

    def position_scale(self, robot: RobotModel) -> Array:
        """Factor from the log's positions to rad or m, signed, shape (n,)."""
        scale = np.where(robot.is_prismatic, LENGTHS[self.length], ANGLES[self.angle])
        return scale * _signs(robot.joints, self.flip_position)

    def velocity_scale(self, robot: RobotModel) -> Array:
        """Factor from the log's velocities to rad/s or m/s, signed, shape (n,)."""
        return self.position_scale(robot) * _signs(robot.joints, self.flip_velocity)

    def effort_scale(self, robot: RobotModel) -> Array:
        """Factor from the log's efforts to N·m or N (gains apart), signed, shape (n,)."""
        scale = np.where(robot.is_prismatic, 1.0, TORQUES[self.torque])
        gears = np.array([self.reduction.get(j, 1.0) for j in robot.joints])
        return scale * gears * _signs(robot.joints, self.flip_effort)

    def notes(self) -> list[str]:
        """Say what was converted, one sentence each."""
        said = []
        if self.angle != "rad":
            said.append(f"angles converted from {self.angle} to rad, as asked")
        if self.length != "m":
            said.append(f"lengths converted from {self.length} to m, as asked")
        if self.torque == "Nmm":
            said.append("efforts converted from N·mm to N·m, as asked")
        for what, joints in (
            ("position and velocity", self.flip_position),
            ("velocity", self.flip_velocity),
            ("effort", self.flip_effort),
        ):
            if joints:
                said.append(f"sign of {what} changed, as asked: {', '.join(joints)}")
        if self.gravity == "compensated":
            said.append("the URDF's gravity torque added to the efforts, as asked")
        if self.reduction:
            gears = ", ".join(f"{j} {r:g}" for j, r in self.reduction.items())
            said.append(f"motor-side efforts multiplied by the gear ratio, as asked: {gears}")
        return said


def _signs(joints: Sequence[str], flipped: Sequence[str]) -> Array:
    return np.array([-1.0 if j in flipped else 1.0 for j in joints])


def _parsed(texts: Sequence[str]) -> dict[str, Any]:
    if isinstance(texts, str):
        texts = [texts]
    out: dict[str, Any] = {}
    for text in texts:
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
