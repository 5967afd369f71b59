"""A term: an effect with numbers and a profile, as a plant has it or a model was given it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.profile import ALWAYS, Profile, profile_from_dict
from cdia_pin.effects.records import ParameterRecord, TermRecord
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal
from cdia_pin.effects.vocabulary import effect_from_dict
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.phrases import counted, plural
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LARGEST = 1e12  # [unit of the parameter], above it a torque overflows
SHOWN = 6  # parameters in a repr, which is one line


@dataclass(frozen=True)
class Term:
    """β(x) Φ(x; s) θ with its numbers.

    Attributes:
        effect: The physics.
        theta: Its parameters, in the effect's order and units.
        profile: Where it is present.
        ci95: 95 % interval of each parameter, where the numbers were estimated.
        ci95_statistical: The same from the scatter of the data alone, where the assumptions were varied too.
    """

    effect: Effect
    theta: tuple[float, ...]
    profile: Profile = ALWAYS
    ci95: tuple[tuple[float, float], ...] | None = field(default=None, compare=False)
    ci95_statistical: tuple[tuple[float, float], ...] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "theta", tuple(float(v) for v in self.theta))  # hashable, and plain in JSON
        if len(self.theta) != self.effect.size:
            names = ", ".join(p.name for p in self.effect.parameters)
            raise EffectError(
                f"{self.effect.label} takes {names}; given {counted(len(self.theta), 'number')}"
            )
        if not np.isfinite(self.theta).all():
            raise EffectError(f"{self.effect.label}: parameters must be finite, given {self.theta}")
        if any(abs(v) > LARGEST for v in self.theta):
            raise EffectError(
                f"{self.effect.label}: parameters must be below {LARGEST:g}, given {self.theta}"
            )

    def __repr__(self) -> str:
        shown = [f"{name}={value:.4g}" for name, value in self.values.items()]
        shown = shown if len(shown) <= SHOWN else [*shown[: SHOWN - 1], "…"]
        where = "" if self.profile == ALWAYS else f", {self.profile.kind}"
        return f"Term({self.label}: {', '.join(shown)}{where})"

    @classmethod
    def of(cls, effect: Effect, profile: Profile = ALWAYS, **parameters: float) -> Term:
        """Build a term from parameters by name; those left out are zero.

        Args:
            effect: The physics.
            profile: Where it is present.
            parameters: Values by name, in the effect's units.
        """
        names = [p.name for p in effect.parameters]
        for name in parameters:
            if name not in names:
                raise EffectError(f"{effect.label}: " + unknown_name("parameter", name, names))
        return cls(effect, tuple(float(parameters.get(n, 0.0)) for n in names), profile)

    def with_theta(self, theta: Sequence[float] | Array) -> Term:
        """Return the term with other parameters, without intervals.

        Args:
            theta: Parameters in the effect's order and units, shape (p,).
        """
        return Term(self.effect, tuple(float(v) for v in theta), self.profile)

    @property
    def half_widths(self) -> Array:
        """Half the width of each 95 % interval, zero where there is none, in the parameters' units, shape (p,)."""
        return np.zeros(len(self.theta)) if self.ci95 is None else np.diff(self.ci95, axis=1)[:, 0] / 2

    @property
    def may_be_nothing(self) -> bool:
        """Whether the interval of every parameter holds zero; false where there are no intervals."""
        return (
            self.ci95 is not None and bool(self.ci95) and all(low <= 0.0 <= high for low, high in self.ci95)
        )

    def with_intervals(self, total: Array, statistical: Array | None = None) -> Term:
        """Return the term with 95 % intervals around its parameters.

        Args:
            total: Half widths, in the parameters' units, shape (p,).
            statistical: Half widths of the statistical part, where the two parts are known, shape (p,).
        """
        return replace(
            self,
            ci95=_around(self.theta, total),
            ci95_statistical=None if statistical is None else _around(self.theta, statistical),
        )

    def less_certain(self, systematic: Array) -> Term:
        """Return the term with total intervals that are wider by one more systematic part, where it has intervals.

        Args:
            systematic: Half widths of that part, in the parameters' units, shape (p,).
        """
        if self.ci95 is None:
            return self
        wider = self.with_intervals(np.hypot(self.half_widths, systematic))
        return replace(wider, ci95_statistical=self.ci95_statistical or self.ci95)

    @property
    def label(self) -> str:
        """The effect's name and scope."""
        return self.effect.label

    @property
    def depends_on(self) -> frozenset[Signal]:
        """Signals that change β Φ."""
        return self.profile.depends_on.union(self.effect.traits.depends_on)

    def check(self, robot: RobotModel) -> None:
        """Make sure that the robot can have the term; raises RobotError or EffectError.

        Args:
            robot: The arm, n joints.
        """
        self.effect.check(robot)
        self.profile.check(robot)

    @property
    def values(self) -> dict[str, float]:
        """Parameters by name."""
        return {p.name: v for p, v in zip(self.effect.parameters, self.theta, strict=True)}

    def torque(self, x: State) -> Array:
        """Return β Φ θ [N·m or N], shape (N, n).

        Args:
            x: Motion and torques, N samples.
        """
        f = self.effect.torque(x, np.array(self.theta))
        return f if self.profile is ALWAYS else self.profile(x)[:, None] * f

    def torques(self, x: State, efforts: Array) -> Array:
        """Return β Φ θ under several actuator torques [N·m or N], shape (N, n, k).

        Args:
            x: The motion, N samples; its ``effort`` is not used.
            efforts: The actuator torques [N·m or N], shape (N, n, k).
        """
        return self.profile(x)[:, None, None] * self.effect.torques(x, efforts, np.array(self.theta))

    def shift(self, x: State) -> Array:
        """Return by how much the arm is further than its encoders read [rad or m], shape (N, n).

        Args:
            x: Motion and torques, N samples.
        """
        return self.profile(x)[:, None] * self.effect.shift(x, np.array(self.theta))

    def gravity_change(self, x: State) -> Array:
        """Return by how much gravity differs from the robot's [m/s²], shape (N, 3).

        Args:
            x: Motion and torques, N samples.
        """
        return self.profile(x)[:, None] * self.effect.gravity_change(x, np.array(self.theta))

    def jacobian(self, x: State) -> Array:
        """Return β ∂f/∂θ, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        return self.profile(x)[:, None, None] * self.effect.jacobian(x, np.array(self.theta))

    def parameters_to_dict(self, robot: RobotModel) -> dict[str, ParameterRecord]:
        """Return {name: {value, unit, ci95}} for files and tables.

        Args:
            robot: The arm, n joints.
        """
        out: dict[str, ParameterRecord] = {}
        units = self.effect.units(robot)
        for i, (p, value, unit) in enumerate(zip(self.effect.parameters, self.theta, units, strict=True)):
            out[p.name] = {"value": value, "unit": unit}
            if self.ci95 is not None:
                out[p.name]["ci95"] = list(self.ci95[i])
            if self.ci95_statistical is not None:
                out[p.name]["ci95_statistical"] = list(self.ci95_statistical[i])
        return out

    def to_dict(self, robot: RobotModel) -> TermRecord:
        """Return a JSON-ready description; `from_dict` reads it back.

        Args:
            robot: The arm, n joints.
        """
        return {
            **self.effect.to_dict(),
            "parameters": self.parameters_to_dict(robot),
            "profile": self.profile.to_dict(),
        }

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> Term:
        """Read back what `to_dict` wrote; a parameter may also be written as a bare number.

        Args:
            given: Effect, joints, shape, parameters and profile, as in a file.

        Raises:
            EffectError: If a name is unknown or a number is missing.
        """
        effect = effect_from_dict(given)
        written = given.get("parameters", {})
        names = [p.name for p in effect.parameters]
        missing = [n for n in names if n not in written]
        if missing:
            raise EffectError(
                f"{effect.label}: no value for {plural('parameter', len(missing))} {', '.join(missing)}"
            )
        for name in written:
            if name not in names:
                raise EffectError(f"{effect.label}: " + unknown_name("parameter", name, names))
        ordered = [w if isinstance(w, Mapping) else {"value": w} for w in (written[n] for n in names)]
        ci95 = None
        if ordered and all("ci95" in p for p in ordered):
            ci95 = tuple((float(p["ci95"][0]), float(p["ci95"][1])) for p in ordered)
        statistical = None
        if ordered and all("ci95_statistical" in p for p in ordered):
            statistical = tuple(
                (float(p["ci95_statistical"][0]), float(p["ci95_statistical"][1])) for p in ordered
            )
        theta = tuple(float(p["value"]) for p in ordered)
        return cls(effect, theta, profile_from_dict(given.get("profile", {})), ci95, statistical)


def _around(theta: Sequence[float], half: Array) -> tuple[tuple[float, float], ...]:
    return tuple((float(v - h), float(v + h)) for v, h in zip(theta, half, strict=True))
