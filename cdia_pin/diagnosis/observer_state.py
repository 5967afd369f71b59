"""The state of the observer by name: views of the one array that the compiled kernels work on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis import kernel_rows as rows
from cdia_pin.diagnosis.layout import Shape, allocate
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.effects import Unknown
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]


class _Row:
    """One row of a part, read as a view and written in place.

    Args:
        part: Name of the part.
        row: Its row, of `kernel_rows`.
    """

    def __init__(self, part: str, row: int) -> None:
        self._part, self._row = part, row

    def __get__(self, state: ObserverState, owner: type | None = None) -> Array:
        view: Array = state.parts[self._part][self._row]
        return view

    def __set__(self, state: ObserverState, value: ArrayLike) -> None:
        state.parts[self._part][self._row] = value


class _Scalar:
    """One number of the part `scalars`.

    Args:
        entry: Its entry, of `kernel_rows`.
    """

    def __init__(self, entry: int) -> None:
        self._entry = entry

    def __get__(self, state: ObserverState, owner: type | None = None) -> float:
        return float(state.parts["scalars"][self._entry])

    def __set__(self, state: ObserverState, value: float) -> None:
        state.parts["scalars"][self._entry] = value


class ObserverState(Stateful):
    """State of n joints with P columns and H neurons each; `kernel_rows` says what each row means.

    Args:
        shapes: Shapes of the parts, as `layout` returns them.

    Attributes:
        array: All of it, shape (S,); the kernels get this.
        parts: A view of each part by name.
        gram: Gram matrices of [y; r], upper triangles, shape (n, P + 1, P + 1).
        absent: Ticks for which an effect's torque has stayed away, shape (n, N).
        mass: M of the last tick, shape (n, n).
        neuron_gram: Gram matrices of the neurons and the residual, upper triangles, shape (n, H + 1, H + 1).
    """

    STATE = ("array",)
    DERIVED = ("parts", "gram", "absent", "mass", "neuron_gram")  # views of it

    def __init__(self, shapes: Mapping[str, Shape]) -> None:
        self.array, self.parts = allocate(shapes)
        self.gram, self.absent = self.parts["gram"], self.parts["absent"]
        self.mass, self.neuron_gram = self.parts["mass"], self.parts["neuron_gram"]

    def take(self, name: str, value: Array) -> None:
        """Take the stored array in place: all the rest are views of it."""
        if value.shape != self.array.shape:
            raise ModelError(f"its filters hold {value.size} numbers instead of {self.array.size}")
        self.array[:] = value

    # Of each joint, shape (n,).
    residual = _Row("joint", rows.RESIDUAL)
    threshold = _Row("joint", rows.THRESHOLD)
    remainder = _Row("joint", rows.REMAINDER)
    exceeded = _Row("joint", rows.EXCEEDED)
    bound = _Row("joint", rows.BOUND)
    rest_bound = _Row("joint", rows.REST_BOUND)
    sign_width = _Row("joint", rows.SIGN_WIDTH)
    velocity = _Row("joint", rows.VELOCITY)
    nle = _Row("joint", rows.NLE)
    collecting = _Row("joint", rows.COLLECTING)
    weight = _Row("joint", rows.WEIGHT)
    outside = _Row("joint", rows.OUTSIDE)
    learning = _Row("joint", rows.LEARNING)
    learned = _Row("joint", rows.LEARNED)
    amplitude = _Row("joint", rows.AMPLITUDE)
    moving = _Row("joint", rows.MOVING)
    muted = _Row("joint", rows.MUTED)
    position = _Row("joint", rows.POSITION)
    bandwidth = _Row("joint", rows.BANDWIDTH)
    addition = _Row("joint", rows.ADDITION)
    soft_sign_width = _Row("joint", rows.SOFT_SIGN_WIDTH)
    rest_speed = _Row("joint", rows.REST_SPEED)
    known_amplitude = _Row("joint", rows.KNOWN_AMPLITUDE)
    lowest_velocity = _Row("joint", rows.LOWEST_VELOCITY)
    steady = _Row("joint", rows.STEADY)
    highest_velocity = _Row("joint", rows.HIGHEST_VELOCITY)

    # Of each column, shape (n, P).
    phi = _Row("columns", rows.PHI)
    filtered = _Row("columns", rows.FILTERED)
    believed = _Row("columns", rows.BELIEVED)
    known = _Row("columns", rows.KNOWN)
    present = _Row("columns", rows.PRESENT)
    phi_tick = _Row("phi", rows.PHI_TICK)
    phi_unloaded = _Row("phi", rows.PHI_UNLOADED)
    phi_loaded = _Row("phi", rows.PHI_LOADED)

    # Of each neuron, shape (n, H).
    activation = _Row("neurons", rows.ACTIVATION)
    activated = _Row("neurons", rows.ACTIVATED)
    weights = _Row("neurons", rows.WEIGHTS)

    time = _Scalar(rows.TIME)
    forget = _Scalar(rows.FORGET)
    remember = _Scalar(rows.REMEMBER)
    debounce = _Scalar(rows.DEBOUNCE)
    absent_ticks = _Scalar(rows.ABSENT_TICKS)
    gain_floor = _Scalar(rows.GAIN_FLOOR)
    learns = _Scalar(rows.LEARNS)
    corrects = _Scalar(rows.CORRECTS)
    driven = _Scalar(rows.DRIVEN)
    neuron_count = _Scalar(rows.NEURON_COUNT)

    def place_neurons(self, unknown: Sequence[Unknown]) -> None:
        """Set centres and widths of the neurons.

        Args:
            unknown: Neurons of each joint, as many of each kind on all joints.
        """
        self.parts["scalars"][list(rows.NEURONS)] = unknown[0].counts[:-1]
        for kind in ("position_centres", "velocity_centres", "damping_centres"):
            self.parts[kind][:] = np.transpose([getattr(u, kind) for u in unknown])
        self.parts["widths"][rows.OF_POSITION] = [u.position_width for u in unknown]
        self.parts["widths"][rows.OF_VELOCITY] = [u.velocity_width for u in unknown]

    def forget_past(self) -> None:
        """Set all that past samples left to zero; bounds, beliefs and learned weights stay."""
        for of_joint in (self.residual, self.threshold, self.remainder, self.exceeded, self.learned):
            of_joint[:] = 0.0
        for of_joint in (self.amplitude, self.known_amplitude, self.moving, self.steady, self.addition):
            of_joint[:] = 0.0
        self.weight = 0.0
        for past in (self.phi, self.filtered, self.activation, self.activated, self.gram, self.absent):
            past[:] = 0.0
        self.neuron_count = 0.0
