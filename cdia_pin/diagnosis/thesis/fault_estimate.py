"""The estimate f̂ of the fault torque: neurons for a fault that is being isolated, beside the isolated effects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.thesis.basis import KnownEffects, Neurons
from cdia_pin.diagnosis.thesis.isolated_faults import IsolatedFaults
from cdia_pin.diagnosis.thesis.sample_interval import SampleInterval
from cdia_pin.diagnosis.thesis.thesis_settings import ThesisSettings
from cdia_pin.diagnosis.thesis.velocity_observers import ColumnScale, VelocityObservers
from cdia_pin.effects import JointState

Array = NDArray[np.float64]

NEURONS = -1  # key of the neurons among the torques, beside the indices of effects


class FaultEstimate(Stateful):
    """What is believed about the fault torque of an arm; nothing at first.

    Args:
        neurons: Approximator of an unknown fault.
        types: The known effects.
        settings: Settings of the engine.
        gamma: γ [1/s], shape (n,).
        absent_torque: Torque of an effect that counts as absent [N·m or N], shape (n,).

    Attributes:
        learning: Whether the neurons approximate a fault: from detection until it is isolated or has cleared.
        observer: The observer with the neurons.
        neuron_scale: Columns of the neurons, and their largest values so far.
        type_scale: Columns of the known effects, and their largest values so far.
        isolated: The isolated effects.
    """

    STATE = ("learning", "observer", "neuron_scale", "type_scale", "isolated")
    DERIVED = ("_at", "_columns")

    def __init__(
        self,
        neurons: Neurons,
        types: KnownEffects,
        settings: ThesisSettings,
        gamma: Array,
        absent_torque: Array,
    ) -> None:
        self.neurons, self.types = neurons, types
        self._gains, self._gamma = settings.observer_gains, gamma
        self.learning = False
        self._at: tuple[Array | None, Array | None] = None, None  # q and q̇ of the columns that are kept
        self._columns = np.empty((0, 0))
        self.neuron_scale, self.type_scale = ColumnScale(neurons), ColumnScale(types)
        self.isolated = IsolatedFaults(types, self.type_scale, absent_torque, settings.filter_gains, gamma)
        self.restart_neurons()

    @property
    def is_empty(self) -> bool:
        """Whether no fault is present."""
        return not self.learning and self.isolated.filter is None

    def restart_neurons(self, error: Array | None = None) -> None:
        """Replace the observer by one whose neurons know nothing.

        Args:
            error: Its velocity error [rad/s or m/s], shape (n,); zero if omitted.
        """
        self.observer = VelocityObservers.fresh(self.neurons, self._gains, self._gamma)
        if error is not None:
            self.observer.error[0] = error

    def see(self, step: SampleInterval) -> None:
        """Evaluate all columns over an interval.

        Args:
            step: The interval.
        """
        self.neuron_scale.see(step)
        self.type_scale.see(step)

    def torque(self, x: JointState) -> Array:
        """Return f̂ at a state [N·m or N], shape (n,).

        Args:
            x: Motion and torque of all joints, each signal of shape (n,).
        """
        f = np.zeros_like(x.effort)
        if self.learning:
            f = f + self.observer.torque(self._neuron_columns(x))[0]
        if self.isolated.filter is not None:
            f = f + self.isolated.filter.torque(self.types.columns(x))[0]
        return f

    def _neuron_columns(self, x: JointState) -> Array:
        """Return the columns of the neurons; at the last state only those of the torque are new, shape (n, P)."""
        if x.q is not self._at[0] or x.v is not self._at[1]:
            self._at, self._columns = (x.q, x.v), self.neurons.columns(x)
        self._columns[:, self.neurons.of_torque] = x.effort[:, None]
        return self._columns

    def torques(self) -> dict[int, Array]:
        """Return the torque of each isolated effect, and of the neurons, over the last interval [N·m or N]."""
        torques = self.isolated.torques()
        if self.learning:
            torques[NEURONS] = self.observer.torque(self.neuron_scale.columns)[0]
        return torques
