"""What sensors do to a signal: quantisation and noise, white or coloured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

COLOURS = ("white", "ar1", "pink")
FLOOR = 0.02  # a joint that carries next to no torque still has noise, as if it had this share of the largest


@dataclass(frozen=True)
class Noise:
    """Imperfections of the recorded signals.

    Attributes:
        position_resolution: Quantum of the positions [rad or m]; 0 for none.
        effort_resolution: Quantum of the torques as a share of each joint's torque RMS [1]; 0 for none.
        effort_fraction: Standard deviation of the torque noise as a share of each joint's torque RMS [1].
        effort_std: Standard deviation of the torque noise [N·m or N], one for all joints or one each;
            replaces `effort_fraction`.
        velocity_std: Standard deviation of the velocity noise, where velocity is recorded [rad/s or m/s].
        colour: Of the torque noise: "white", "ar1" (first-order low-pass) or "pink" (power as 1/f).
        memory: Time constant of "ar1" [s].
    """

    position_resolution: float = 1e-5
    effort_resolution: float = 0.0
    effort_fraction: float = 0.01
    effort_std: float | tuple[float, ...] | None = None
    velocity_std: float = 0.0
    colour: str = "white"
    memory: float = 0.02

    def __post_init__(self) -> None:
        if self.colour not in COLOURS:
            raise ValueError(f"unknown noise colour '{self.colour}'; known: {', '.join(COLOURS)}")

    def read_position(self, position: Array) -> Array:
        """Return positions rounded to their quantum [rad or m], shape as given."""
        return _rounded(position, self.position_resolution)

    def read_effort(self, true: Array, rate: float, rng: np.random.Generator) -> Array:
        """Return torques with noise, rounded to their quantum [N·m or N], shape as given (N, n)."""
        noisy = true + self.std_of(true) * self.draw(true.shape, rate, rng)
        return _rounded(noisy, self.effort_resolution * _size(true))

    def std_of(self, effort: Array) -> Array:
        """Return the noise's standard deviation on each joint for true torques (N, n), shape (n,)."""
        n = effort.shape[1]
        if self.effort_std is not None:
            return np.array(np.broadcast_to(np.asarray(self.effort_std, float), (n,)))
        return self.effort_fraction * _size(effort)

    def keep(self, rate: float) -> float:
        """Return the correlation of the torque noise one sample apart, 0 if it is white [1]."""
        return float(np.exp(-1.0 / (rate * self.memory))) if self.colour == "ar1" else 0.0

    def draw(self, shape: tuple[int, int], rate: float, rng: np.random.Generator) -> Array:
        """Return noise of standard deviation 1 in the chosen colour, sampled at `rate` [Hz]."""
        white = rng.standard_normal(shape)
        if self.colour == "white":
            return white
        if self.colour == "ar1":
            keep = self.keep(rate)
            first = white[:1] / np.sqrt(1 - keep**2)  # stationary from the first sample
            gain = np.sqrt(1 - keep**2)
            return lfilter([gain], [1.0, -keep], np.vstack([first, white[1:]]), axis=0)
        spectrum = np.fft.rfft(white, axis=0)
        index = np.maximum(np.arange(len(spectrum)), 1)[:, None]
        coloured = np.fft.irfft(spectrum / np.sqrt(index), n=shape[0], axis=0)
        return coloured / coloured.std(axis=0)


def _size(effort: Array) -> Array:
    """Return the RMS of each joint's torque, raised where a joint carries next to none [N·m or N], shape (n,)."""
    rms = np.sqrt(np.mean(effort**2, axis=0))
    return np.maximum(rms, FLOOR * rms.max())


def _rounded(signal: Array, quantum: float | Array) -> Array:
    if not np.any(quantum):
        return signal.copy()
    return np.round(signal / quantum) * quantum


CLEAN = Noise(position_resolution=0.0, effort_fraction=0.0)
