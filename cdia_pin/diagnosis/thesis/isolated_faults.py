"""The effects isolated so far: the filter that follows their parameters, and which of them act where."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.thesis.basis import KnownEffects
from cdia_pin.diagnosis.thesis.filter_bank import Types
from cdia_pin.diagnosis.thesis.gains import Gains
from cdia_pin.diagnosis.thesis.velocity_observers import ColumnScale, VelocityObservers
from cdia_pin.effects import Term

Array = NDArray[np.float64]


class IsolatedFaults(Stateful):
    """The isolated effects of an arm; none at first.

    Args:
        basis: The known effects.
        scale: Columns of the basis, and their largest values so far.
        absent_torque: Torque of an effect that counts as absent [N·m or N], shape (n,).
        gains: Adaptation law of the filter.
        gamma: γ [1/s], shape (n,).

    Attributes:
        filter: The filter that follows their parameters; None if there are none.
        types: Indices of the isolated effects.
    """

    STATE = ("filter", "types")

    def __init__(
        self, basis: KnownEffects, scale: ColumnScale, absent_torque: Array, gains: Gains, gamma: Array
    ) -> None:
        self._basis, self._scale, self._absent_torque = basis, scale, absent_torque
        self._gains, self._gamma = gains, gamma
        self.filter: VelocityObservers | None = None
        self.types: Types = frozenset()

    def new_part(self, name: str) -> VelocityObservers:
        """Make a filter that knows nothing."""
        return VelocityObservers.fresh(self._basis, self._gains, self._gamma)

    def replace(self, filter_: VelocityObservers, types: Types) -> None:
        """Replace all isolated effects.

        Args:
            filter_: A single filter.
            types: Indices of its effects.
        """
        self.filter, self.types = filter_, types

    def clear(self, types: Types) -> None:
        """Remove effects.

        Args:
            types: Their indices.
        """
        assert self.filter is not None
        self.types -= types
        kept = np.isin(self._basis.of_type, list(self.types))
        self.filter.used *= kept
        self.filter.weights *= kept
        if not self.types:
            self.filter = None

    def torques(self) -> dict[int, Array]:
        """Return the torque of each isolated effect now [N·m or N], shape (n,), by index."""
        if self.filter is None:
            return {}
        each = self._scale.columns * self.filter.weights[0]
        return {i: each[:, self._basis.of_type == i].sum(axis=1) for i in self.types}

    def terms(self, types: Types | None = None) -> tuple[Term, ...]:
        """Return the isolated effects that act, with the parameters learned so far.

        Args:
            types: Indices of the effects asked for; all isolated ones if omitted.
        """
        if self.filter is None:
            return ()
        return self.terms_of(self.filter, self.types if types is None else types)

    def terms_of(self, filter_: VelocityObservers, types: Types) -> tuple[Term, ...]:
        """Return the effects of a filter that act, with the parameters that it has learned.

        Args:
            filter_: A single filter.
            types: Indices of its effects.
        """
        return self._basis.terms(filter_.weights[0], self._acting(filter_, types))

    def acting(self) -> NDArray[np.bool_]:
        """Return on which joints any isolated effect acts, shape (n,)."""
        if self.filter is None:
            return np.zeros(self._basis.robot.n, dtype=bool)
        return np.asarray(np.any(self._acting(self.filter, self.types), axis=1))

    def _acting(self, filter_: VelocityObservers, types: Types) -> NDArray[np.bool_]:
        """Return which effect acts on which joint by more than what counts as absent, shape (n, N)."""
        most = np.abs(filter_.weights[0]) * self._scale.largest
        return np.stack(
            [
                (most[:, self._basis.of_type == i].sum(axis=1) > self._absent_torque) & (i in types)
                for i in range(len(self._basis.effects))
            ],
            axis=1,
        )
