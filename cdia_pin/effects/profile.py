"""Profiles β ∈ [0, 1]: where in time or state an effect is present ([Thesis] 2.2.2)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from numbers import Real
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
INF = float("inf")
SIGNAL_OF_REGION = {
    "position": Signal.POSITION,
    "velocity": Signal.VELOCITY,
    "speed": Signal.VELOCITY,
    "effort": Signal.TORQUE,
}


class Profile(ABC):
    """Presence of an effect; a subclass is a frozen dataclass of its numbers."""

    kind: ClassVar[str]
    words: ClassVar[tuple[str, ...]] = ()  # fields that are names; all others are numbers

    def __post_init__(self) -> None:
        for name, given in asdict(self).items():  # type: ignore[call-overload]
            if name in self.words:
                if not isinstance(given, str):
                    raise EffectError(f"profile '{self.kind}': {name} must be a name, given {given!r}")
            elif isinstance(given, bool) or not isinstance(given, Real) or np.isnan(float(given)):
                raise EffectError(f"profile '{self.kind}': {name} must be a number, given {given!r}")

    @property
    def depends_on(self) -> frozenset[Signal]:
        """Signals that change β."""
        return frozenset({Signal.TIME})

    def check(self, robot: RobotModel) -> None:  # noqa: B027  (most profiles name nothing)
        """Make sure that the robot has what the profile names; raises RobotError.

        Args:
            robot: The arm, n joints.
        """

    @abstractmethod
    def __call__(self, x: State) -> Array:
        """Return β [1] at each sample, shape (N,)."""

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description; infinite numbers are left out."""
        numbers = {k: v for k, v in asdict(self).items() if v not in (INF, -INF)}  # type: ignore[call-overload]
        return {"kind": self.kind, **numbers}


@dataclass(frozen=True)
class Always(Profile):
    """Present all the time."""

    kind: ClassVar[str] = "always"

    @property
    def depends_on(self) -> frozenset[Signal]:
        """Nothing."""
        return frozenset()

    def __call__(self, x: State) -> Array:
        """Return one at each sample."""
        return np.ones(len(x))


@dataclass(frozen=True)
class Between(Profile):
    """Present from a time on, until another.

    Attributes:
        start: First moment [s].
        end: Last moment [s].
    """

    start: float = -INF
    end: float = INF

    kind: ClassVar[str] = "between"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.start < self.end:
            raise EffectError(f"a profile must start before it ends, given {self.start} s to {self.end} s")

    def __call__(self, x: State) -> Array:
        """Return one within the times."""
        return ((x.time >= self.start) & (x.time <= self.end)).astype(float)


def after(start: float) -> Between:
    """Return the profile that is present from a time on [s].

    Args:
        start: First moment [s].
    """
    return Between(start=start)


@dataclass(frozen=True)
class Region(Profile):
    """Present while a signal of a joint is within a region.

    Attributes:
        joint: Name of the joint.
        signal: ``position``, ``velocity``, ``speed`` (its absolute value) or ``effort``.
        lower: Where the region begins [unit of the signal].
        upper: Where it ends [unit of the signal].
    """

    joint: str
    signal: str
    lower: float = -INF
    upper: float = INF

    kind: ClassVar[str] = "region"
    words: ClassVar[tuple[str, ...]] = ("joint", "signal")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.signal not in SIGNAL_OF_REGION:
            raise EffectError(unknown_name("signal of a region", self.signal, SIGNAL_OF_REGION))
        if not self.lower < self.upper:
            raise EffectError(f"a region must begin below its end, given {self.lower} to {self.upper}")

    @property
    def depends_on(self) -> frozenset[Signal]:
        """The signal of the region."""
        return frozenset({SIGNAL_OF_REGION[self.signal]})

    def check(self, robot: RobotModel) -> None:
        """Make sure that the joint is of the robot; raises RobotError.

        Args:
            robot: The arm, n joints.
        """
        robot.joint_index(self.joint)

    def __call__(self, x: State) -> Array:
        """Return one within the region."""
        joint = x.joint(self.joint)
        signals = {"position": joint.q, "velocity": joint.v, "speed": np.abs(joint.v), "effort": joint.effort}
        value = signals[self.signal]
        return ((value >= self.lower) & (value <= self.upper)).astype(float)


@dataclass(frozen=True)
class Incipient(Profile):
    """Growing from a time on, β = 1 − exp(−rate (t − start)).

    Attributes:
        start: When it begins [s].
        rate: How fast it grows [1/s].
    """

    start: float = 0.0
    rate: float = 1.0

    kind: ClassVar[str] = "incipient"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (0 < self.rate < INF and np.isfinite(self.start)):
            raise EffectError(
                f"an incipient profile needs a start and a rate above 0 1/s, given {self.start}, {self.rate}"
            )

    def __call__(self, x: State) -> Array:
        """Return the share that has grown."""
        return -np.expm1(-self.rate * np.maximum(x.time - self.start, 0.0))


@dataclass(frozen=True)
class Intermittent(Profile):
    """Coming and going, present for the first part of each period.

    Attributes:
        start: When the first period begins [s].
        period: Length of a period [s].
        duty: Share of a period in which the effect is present [1].
    """

    start: float = 0.0
    period: float = 1.0
    duty: float = 0.5

    kind: ClassVar[str] = "intermittent"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (np.isfinite(self.start) and 0 < self.period < INF and 0 < self.duty <= 1):
            raise EffectError(
                "an intermittent profile needs a start [s], a period above 0 [s] and 0 < duty ≤ 1, given "
                f"{self.start}, {self.period}, {self.duty}"
            )

    def __call__(self, x: State) -> Array:
        """Return one in the present part of each period."""
        since = x.time - self.start
        return ((since >= 0) & (np.mod(since, self.period) < self.duty * self.period)).astype(float)


ALWAYS = Always()
PROFILES: dict[str, type[Profile]] = {p.kind: p for p in (Always, Between, Region, Incipient, Intermittent)}


def profile_from_dict(given: Mapping[str, Any]) -> Profile:
    """Read back what `Profile.to_dict` wrote; raises EffectError with what is valid.

    Args:
        given: Kind and numbers, as in a file.
    """
    numbers = dict(given)
    kind = str(numbers.pop("kind", "always"))
    if kind not in PROFILES:
        raise EffectError(unknown_name("profile", kind, PROFILES))
    try:
        return PROFILES[kind](**numbers)
    except TypeError:
        fields = ", ".join(PROFILES[kind].__dataclass_fields__)  # type: ignore[attr-defined]
        given_fields = ", ".join(map(str, numbers)) or "nothing"
        raise EffectError(f"profile '{kind}' takes {fields or 'nothing'}, given {given_fields}") from None
