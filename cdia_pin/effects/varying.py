r"""Effects whose parameters vary: from log to log, or slowly within one.

.. math:: f = \Phi(x) \sum_k w_k(x)\,\theta_k, \qquad \sum_k w_k = 1

Each θₖ is a full set of the effect's parameters, with its units and bounds; where all of them are equal, the effect
is the plain one.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.records import EffectRecord
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Channel, Signal, Traits
from cdia_pin.effects.wrapped import WrappedEffect
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class Varying(WrappedEffect):
    """An effect that has its parameters several times: a subclass says where which of them hold.

    Subclasses are frozen dataclasses whose first field is the effect.
    """

    kind: ClassVar[str]  # what the parameters vary with

    def __post_init__(self) -> None:
        if self.effect.traits.channel is Channel.POSITION_READING:
            raise EffectError(f"{self.effect.label}: the zero of an encoder cannot vary with {self.kind}")

    # ------------------------------------------------------------- what a subclass gives

    @property
    @abstractmethod
    def parts(self) -> tuple[str, ...]:
        """What each set of parameters is called."""

    @abstractmethod
    def weights(self, x: State) -> Array:
        """Return wₖ at each sample, each row adding up to one, shape (N, number of parts)."""

    @abstractmethod
    def variation(self) -> dict[str, Any]:
        """Return a JSON-ready description of how the parameters vary; `varied` reads it back."""

    # ------------------------------------------------------------- what differs from the plain effect

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """The effect's parameters, once for each part."""
        return tuple(
            replace(p, name=f"{p.name}[{part}]") for part in self.parts for p in self.effect.parameters
        )

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """The effect's bodies, once for each part: each of them is possible by itself."""
        return self.effect.bodies * len(self.parts)

    def of_part(self, theta: Sequence[float] | Array, part: str) -> tuple[float, ...]:
        """Return the effect's parameters in one part, shape (p of the effect,).

        Args:
            theta: Parameters of all parts, one part after another, shape (p,).
            part: Name of the part, one of `parts`.
        """
        return tuple(float(v) for v in self._split(np.asarray(theta))[self.parts.index(part)])

    def basis(self, x: State) -> Array:
        """Return Φ with each part's weight, shape (N, n, p)."""
        return self._weighted(x, [self.effect.basis(x)] * len(self.parts))

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n)."""
        w = self.weights(x)
        if self.effect.traits.linear:
            return np.asarray(np.einsum("nip,np->ni", self.effect.basis(x), w @ self._split(theta)))
        parts = [self.effect.torque(x, part) for part in self._split(theta)]
        return np.asarray(np.einsum("nk,kni->ni", w, np.stack(parts)))

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ, shape (N, n, p)."""
        return self._weighted(x, [self.effect.jacobian(x, part) for part in self._split(theta)])

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return by how much gravity differs from the robot's in the parts that hold [m/s²], shape (N, 3)."""
        parts = [self.effect.gravity_change(x, part) for part in self._split(theta)]
        return np.asarray(np.einsum("nk,kng->ng", self.weights(x), np.stack(parts)))

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the effect's bounds, once for each part."""
        lower, upper = self.effect.bounds(robot)
        return np.tile(lower, len(self.parts)), np.tile(upper, len(self.parts))

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether the parameters of every part can belong to a real arm."""
        return all(self.effect.is_physical(part, robot) for part in self._split(theta))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the physical parameters next to an estimate, shape (p,)."""
        return np.concatenate([self.effect.nearest_physical(p, robot) for p in self._split(theta)])

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the effect's prior standard deviations, once for each part, shape (p,)."""
        return np.tile(self.effect.prior_scale(robot), len(self.parts))

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether every part is more than a simpler effect."""
        return all(self.effect.is_distinct(part) for part in self._split(theta))

    @property
    def label(self) -> str:
        """The effect's label and what its parameters vary with, ``coulomb_friction@elbow_joint[log]``."""
        return f"{self.effect.label}[{self.kind}]"

    def units(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the unit of each parameter on this robot."""
        return self.effect.units(robot) * len(self.parts)

    def to_dict(self) -> EffectRecord:
        """Return a JSON-ready description: the effect's own, and how its parameters vary."""
        return {**self.effect.to_dict(), "varies": self.variation()}

    def _split(self, theta: Array) -> Array:
        return np.reshape(theta, (len(self.parts), self.effect.size))

    def _weighted(self, x: State, phi: Sequence[Array]) -> Array:
        w = self.weights(x)
        return np.concatenate([w[:, k, None, None] * p for k, p in enumerate(phi)], axis=2)


@dataclass(frozen=True)
class PerLog(Varying):
    """An effect with parameters of its own in each log, or in each condition that several logs share.

    A motion that belongs to none of them has their mean.

    Attributes:
        effect: The effect.
        logs: Names of the logs or conditions, see `State.log`.
    """

    effect: Effect
    logs: tuple[str, ...]

    kind: ClassVar[str] = "log"

    def __post_init__(self) -> None:
        if len(set(self.logs)) < max(len(self.logs), 2):
            raise EffectError(
                f"{self.effect.label}: parameters per log need logs of different names, given {self.logs}"
            )
        super().__post_init__()

    @property
    def parts(self) -> tuple[str, ...]:
        """The logs."""
        return self.logs

    def weights(self, x: State) -> Array:
        """Return one in the log that the state is of, shape (N, number of logs)."""
        row = np.array([float(name == x.log) for name in self.logs])
        return np.tile(row if row.any() else np.full(len(row), 1.0 / len(row)), (len(x), 1))

    def variation(self) -> dict[str, Any]:
        """Return the logs."""
        return {"with": self.kind, "logs": list(self.logs)}


@dataclass(frozen=True)
class Drift(Varying):
    r"""An effect that drifts within a log, as friction does while a drive warms up.

    .. math:: \theta(t) = \theta_0 + (\theta_1 - \theta_0)\,\frac{1 - e^{-(t - t_0)/T}}{1 - e^{-(t_1 - t_0)/T}}

    Attributes:
        effect: The effect; its own shape is kept.
        start: t₀ [s], where its first parameters hold; before, they hold too.
        end: t₁ [s], where its second parameters hold.
        time_constant: T [s]; much longer than the log, the drift is linear.
    """

    effect: Effect
    start: float
    end: float
    time_constant: float

    kind: ClassVar[str] = "time"
    shape = (Parameter("time_constant", "s", lower=1e-3),)
    parts = ("start", "end")

    def __post_init__(self) -> None:
        if not (self.start < self.end and self.time_constant > 0):
            raise EffectError(
                f"{self.effect.label}: a drift needs start < end and a time constant above 0 s, "
                f"given {self.start}, {self.end}, {self.time_constant}"
            )
        super().__post_init__()

    def weights(self, x: State) -> Array:
        """Return the shares of the first and of the second parameters, shape (N, 2)."""
        since = np.maximum(x.time - self.start, 0.0) / self.time_constant
        share = np.expm1(-since) / np.expm1(-(self.end - self.start) / self.time_constant)
        return np.column_stack([1.0 - share, share])

    def variation(self) -> dict[str, Any]:
        """Return times and time constant [s]."""
        return {"with": self.kind, "start": self.start, "end": self.end, "time_constant": self.time_constant}

    @property
    def traits(self) -> Traits:
        """Traits of the effect; it depends on time as well."""
        inner = self.effect.traits
        return replace(inner, depends_on={Signal.TIME, *inner.depends_on})

    @property
    def shape_values(self) -> dict[str, float]:
        """The time constant [s]."""
        return {"time_constant": self.time_constant}

    def with_shape(self, **shape: float) -> Self:
        """Return the drift with another time constant [s].

        Args:
            shape: ``time_constant`` [s].
        """
        return replace(self, **shape)  # type: ignore[arg-type]

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return time constants from a quarter of the log's length to twice its length: a drift is slow."""
        length = self.end - self.start
        return [self.with_shape(time_constant=float(t)) for t in length * np.geomspace(0.25, 2.0, 4)]


def varied(effect: Effect, how: Mapping[str, Any]) -> Varying:
    """Read back what `Varying.variation` wrote; raises EffectError with what is valid.

    Args:
        effect: The plain effect.
        how: What its parameters vary with, as in a file.
    """
    given = dict(how)
    kind = str(given.pop("with", ""))
    kinds: dict[str, type[PerLog] | type[Drift]] = {PerLog.kind: PerLog, Drift.kind: Drift}
    if kind not in kinds:
        raise EffectError(unknown_name("variation", kind, kinds))
    if "logs" in given:
        given["logs"] = tuple(map(str, given["logs"]))
    try:
        return kinds[kind](effect, **given)
    except TypeError as error:
        raise EffectError(
            f"{effect.label}: how it varies with {kind} is not written as it must be ({error})"
        ) from None
