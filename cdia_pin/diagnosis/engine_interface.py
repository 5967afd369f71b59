"""The interface of an engine: what `Monitor` needs of a scheme, and nothing more."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.isolation import Decision
from cdia_pin.diagnosis.sight import JointSight
from cdia_pin.diagnosis.status import Status
from cdia_pin.effects import Term
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]


class BadSampleError(ModelError):
    """A sample that cannot be used: not finite, or not later than the last."""


class Engine(Protocol):
    """A scheme of detection, isolation and accommodation, which also notices when a fault has cleared."""

    @property
    def learned(self) -> Any:
        """What healthy runs taught, or a threshold stands for; `Knowledge.learned` takes it in place of them."""
        ...

    @property
    def nothing(self) -> Array:
        """Zero, the same array each time, for a status with no correction; another zero is as good, but slower."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What healthy runs taught, one sentence each."""
        ...

    @property
    def sight(self) -> dict[str, JointSight]:
        """Threshold and healthy torque of each joint, by its name; empty for an engine without torque thresholds."""
        ...

    def update(self, t: float, q: Array, v: Array | None, tau: Array) -> Status:
        """Take one tick.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); None where there are none.
            tau: Torque that has acted since the last tick [N·m or N], shape (n,).
        """
        ...

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque to command in place of a nominal one [N·m or N], shape (n,).

        Args:
            tau: The nominal torque [N·m or N], shape (n,).
            v_desired: Velocity in whose direction dry friction is compensated [rad/s or m/s], shape (n,); the
                measured one if omitted.
        """
        ...

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults now believed in."""
        ...

    @property
    def decisions(self) -> tuple[Decision | None, ...]:
        """The last decision on each joint, None before its first; empty for an engine without such decisions."""
        ...

    @property
    def needs_even_ticks(self) -> bool:
        """Whether a tick left out is to be filled, because signals are shifted or differentiated by ticks."""
        ...

    def pause(self) -> None:
        """Forget past samples: the next one starts the filters again. Beliefs stay."""
        ...

    def reset(self) -> None:
        """Return to the start; what healthy runs taught stays."""
        ...
