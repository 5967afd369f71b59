"""A conditioned log: motion and torque that can be compared, and the record of how they were made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypedDict

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import ArrayLike, NDArray

from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.phrases import numbered, shortened

Array = NDArray[np.float64]

AT_ONCE = (
    16  # compared samples [1] that one product of matrices computes: fewer cost calls, more multiply zeros
)
KERNEL = 5.0  # [periods of the cut-off], after which the filter's impulse response is below 10⁻⁵ of its peak


class MotionRecord(TypedDict):
    """Record of a conditioning, as results and reports write it.

    Attributes:
        cutoff: Cut-off of the compared torques [Hz].
        motion_cutoff: Cut-off of positions, velocities, accelerations and torques before they are compared [Hz].
        trim: Length cut from both ends [periods of the cut-off].
        source: Name of the log.
        condition: Condition that the log shares with others; empty if none.
        sha256: Hash of the log's file.
        log_rate: Rate of the log [Hz].
        motion_rate: Rate of the motion [Hz].
        compared_rate: Rate of the compared torques [Hz].
        velocity: Origin of the velocities, in words.
        acceleration_drowned: Joints whose acceleration is no more than noise and was set to zero.
        notes: Notes of the log and of its resampling.
    """

    cutoff: float
    motion_cutoff: float
    trim: float
    source: str
    condition: str
    sha256: str
    log_rate: float
    motion_rate: float
    compared_rate: float
    velocity: str
    acceleration_drowned: list[str]
    notes: list[str]


@dataclass(frozen=True, repr=False)
class Motion:
    """A conditioned log.

    Attributes:
        joints: Joint names.
        time: Time [s], uniform in each stretch, shape (N,).
        q: Positions [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n); zero for a joint whose accelerations are only noise.
        effort: Torques, filtered like the positions [N·m or N], shape (N, n).
        rate: Samples per second of all of these [Hz].
        cutoff: Cut-off of the compared torques [Hz], below that of the motion.
        decimation: Number of samples per compared torque [1].
        speed_noise: Standard deviation of the noise in v [rad/s or m/s], shape (n,).
        acceleration_noise: Standard deviation of the error of a below `cutoff` [rad/s² or m/s²], shape (n,).
        effort_step: Step between the levels of rounded torques [N·m or N], shape (n,); 0 where they are not rounded.
        record: Record of the conditioning, for files and reports.
        temperature: Temperatures of the joints [°C], shape (N, n); None if they were not recorded.
        torque_side: Side of the gear on which the torque was measured, as far as it is known.
        side_of_format: Whether the format alone says so: a torque that shows much friction decides otherwise.
        effort_tolerance: Tolerance of the scale of each joint's torque, 95 % [1], shape (n,); None if nobody states it.
        stretches: Samples of each stretch of a long log that is looked at; empty if it is looked at whole.
    """

    joints: tuple[str, ...]
    time: Array
    q: Array
    v: Array
    a: Array
    effort: Array
    rate: float
    cutoff: float
    decimation: int
    speed_noise: Array
    acceleration_noise: Array
    effort_step: Array
    record: MotionRecord
    temperature: Array | None = None
    torque_side: TorqueSide = TorqueSide.UNKNOWN
    side_of_format: bool = False
    effort_tolerance: Array | None = None
    stretches: tuple[int, ...] = ()

    def __repr__(self) -> str:
        size = f"{len(self.joints)} joints, {len(self.time)} samples at {self.rate:.4g} Hz"
        return f"Motion({shortened(self.record['source'])}, {size}, cut-off {self.cutoff:.3g} Hz)"

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Indices of the compared samples: every `decimation`-th, far enough from the ends, shape (K,)."""
        return np.concatenate([start + kept for start, _, kept in self._parts])

    @cached_property
    def lengths(self) -> list[int]:
        """Compared samples of each stretch."""
        return [len(kept) for _, _, kept in self._parts]

    @cached_property
    def _parts(self) -> list[tuple[int, int, NDArray[np.intp]]]:
        """First sample of each stretch, the end, and the indices of its compared samples after the first one."""
        cut = int(np.ceil(self.record["trim"] / self.cutoff * self.rate / self.decimation))
        out, start = [], 0
        for length in self.stretches or (len(self.time),):
            every = np.arange(0, length, self.decimation)
            out.append((start, start + length, every[cut : len(every) - cut]))
            start += length
        return out

    @cached_property
    def _kernel(self) -> Array:
        """Impulse response of the filter of compared torques [1], shape (2 reach + 1,)."""
        shortest = min(self.stretches, default=len(self.time))
        reach = min(int(np.ceil(KERNEL / self.cutoff * self.rate)), shortest - 1)
        impulse = np.zeros(4 * reach + 1)
        impulse[2 * reach] = 1.0
        kernel = zero_phase(impulse, self.cutoff, self.rate)[reach : 3 * reach + 1]
        return np.asarray(kernel / kernel.sum())

    @cached_property
    def _weights(self) -> Array:
        """Weights of `AT_ONCE` compared samples in the samples around them, shape (AT_ONCE, span)."""
        out = np.zeros((AT_ONCE, (AT_ONCE - 1) * self.decimation + len(self._kernel)))
        for k in range(AT_ONCE):
            out[k, k * self.decimation :][: len(self._kernel)] = self._kernel
        return out

    def compared(self, torque: ArrayLike) -> Array:
        """Filter a torque and decimate it to the samples that are compared.

        It equals `zero_phase`, and computes only the samples that are kept.

        Args:
            torque: Torque along this motion [N·m or N], shape (N,) or (N, n).

        Returns:
            Filtered torque [N·m or N], shape (K,) or (K, n).
        """
        x = np.asarray(torque, dtype=float)
        columns = x.reshape(len(x), -1)
        parts = [self._decimated(columns[start:end], kept) for start, end, kept in self._parts]
        out = parts[0] if len(parts) == 1 else np.concatenate(parts)
        return out.reshape(len(out), *x.shape[1:])

    def _decimated(self, x: Array, kept: NDArray[np.intp]) -> Array:
        """Filter one stretch, shape (N, n), and return the samples that are kept, shape (K, n)."""
        if not len(kept):
            return x[:0]
        reach, span = len(self._kernel) // 2, self._weights.shape[1]
        hop = AT_ONCE * self.decimation
        times = -(-len(kept) // AT_ONCE)
        # the signal from the first sample that is needed to the last, and zeros to whole windows
        first, end = int(kept[0]) - reach, int(kept[-1]) + reach + 1
        needed = np.zeros(((times - 1) * hop + span, x.shape[1]))
        inside = slice(max(first, 0), min(end, len(x)))
        needed[inside.start - first : inside.stop - first] = x[inside]
        # beyond its ends the signal is continued as its odd mirror image: x(end ± i) = 2 x(end) − x(end ∓ i)
        if first < 0:
            needed[:-first] = 2 * x[0] - x[-first:0:-1]
        if end > len(x):
            beyond = end - len(x)
            needed[len(x) - first : end - first] = 2 * x[-1] - x[-2 : -2 - beyond : -1]
        step = needed.strides[0]
        windows = as_strided(
            needed, (times, span, x.shape[1]), (hop * step, step, needed.strides[1]), writeable=False
        )
        return np.asarray(np.matmul(self._weights, windows).reshape(-1, x.shape[1])[: len(kept)])

    def sampled(self, signal: ArrayLike) -> Array:
        """Return a signal at the samples that are compared, unfiltered.

        Args:
            signal: Any signal of this motion, shape (N,) or (N, n).

        Returns:
            Shape (K,) or (K, n), in the unit of the signal.
        """
        return np.asarray(signal)[self.kept]


def names_of(motions: Sequence[Motion]) -> list[str]:
    """Return each log's condition, or its own name; repeated names are numbered.

    Args:
        motions: Conditioned logs.
    """
    out: list[str] = []
    for motion in motions:
        out.append(motion.record["condition"] or numbered(motion.record["source"], out))
    return out
