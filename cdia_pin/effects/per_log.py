"""Effects with parameters of their own in each log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.state import State
from cdia_pin.effects.varying import Varying
from cdia_pin.errors import EffectError

Array = NDArray[np.float64]


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
                f"{self.effect.label}: parameters per log need two logs or more of different names, given "
                f"{', '.join(self.logs) or 'none'}"
            )
        super().__post_init__()

    @property
    def parts(self) -> tuple[str, ...]:
        """The logs."""
        return self.logs

    def weights(self, x: State) -> Array:
        """Return one in the log that the state is of, shape (N, number of logs).

        Args:
            x: Motion and torques, N samples.
        """
        row = np.array([float(name == x.log) for name in self.logs])
        return np.tile(row if row.any() else np.full(len(row), 1.0 / len(row)), (len(x), 1))

    def variation(self) -> dict[str, Any]:
        """Return the logs."""
        return {"with": self.kind, "logs": list(self.logs)}
