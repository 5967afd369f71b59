"""Effects that drift within a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.effects.varying import Varying
from cdia_pin.errors import EffectError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drift(Varying):
    r"""An effect that drifts within a log, as friction does while a drive warms up.

    .. math:: \theta(t) = \theta_0 + (\theta_1 - \theta_0)\,\frac{1 - e^{-(t - t_0)/T}}{1 - e^{-(t_1 - t_0)/T}}

    Attributes:
        effect: The effect; its own shape is kept.
        start: t₀ [s], where its first parameters hold; before, they hold too.
        end: t₁ [s], where its second parameters hold; after it, they hold too: a trend of seconds is no forecast.
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
        """Return the shares of the first and of the second parameters, shape (N, 2).

        Args:
            x: Motion and torques, N samples.
        """
        since = np.clip(x.time - self.start, 0.0, self.end - self.start) / self.time_constant
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
        """Return time constants from a quarter of the log's length to twice its length: a drift is slow.

        Args:
            x: Motion and torques, N samples.
        """
        length = self.end - self.start
        return [self.with_shape(time_constant=float(t)) for t in length * np.geomspace(0.25, 2.0, 4)]
