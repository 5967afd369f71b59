"""A conditioned log: motion and torque that can be compared, and the record of how they were made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.phrases import shortened

Array = NDArray[np.float64]

KERNEL = 5.0  # [periods of the cut-off], after which the filter's impulse response is below 10⁻⁵ of its peak


class MotionRecord(TypedDict):
    """Record of a conditioning, as results and reports write it.

    Attributes:
        cutoff: Cut-off of the filter [Hz].
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
        time: Time [s], uniform, shape (N,).
        q: Positions [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n); zero for a joint whose accelerations are only noise.
        effort: Torques, filtered once like the positions [N·m or N], shape (N, n).
        rate: Samples per second of all of these [Hz].
        cutoff: Cut-off of the filter [Hz].
        decimation: Number of samples per compared torque [1].
        speed_noise: Standard deviation of the noise in v [rad/s or m/s], shape (n,).
        acceleration_noise: Standard deviation of the error of a [rad/s² or m/s²], shape (n,).
        effort_step: Step between the levels of rounded torques [N·m or N], shape (n,); 0 where they are not rounded.
        record: Record of the conditioning, for files and reports.
        temperature: Temperatures of the joints [°C], shape (N, n); None if they were not recorded.
        torque_side: Side of the gear on which the torque was measured, as far as it is known.
        effort_tolerance: Tolerance of the scale of each joint's torque, 95 % [1], shape (n,); None if nobody states it.
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
    effort_tolerance: Array | None = None

    def __repr__(self) -> str:
        size = f"{len(self.joints)} joints, {len(self.time)} samples at {self.rate:.4g} Hz"
        return f"Motion({shortened(self.record['source'])}, {size}, cut-off {self.cutoff:.3g} Hz)"

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Indices of the compared samples: every `decimation`-th, far enough from the ends, shape (K,)."""
        every = np.arange(0, len(self.time), self.decimation)
        cut = int(np.ceil(self.record["trim"] / self.cutoff * self.rate / self.decimation))
        return every[cut : len(every) - cut]

    @cached_property
    def _filter(self) -> Any:
        """The zero-phase filter at the samples that are compared, a sparse matrix of shape (K, N).

        It equals `zero_phase` and is ten times faster, because it computes only the samples that are kept. Beyond
        its ends the signal is continued as its odd mirror image.
        """
        from scipy.sparse import csr_array

        count = len(self.time)
        reach = min(int(np.ceil(KERNEL / self.cutoff * self.rate)), count - 1)
        impulse = np.zeros(4 * reach + 1)
        impulse[2 * reach] = 1.0
        kernel = zero_phase(impulse, self.cutoff, self.rate)[reach : 3 * reach + 1]
        kernel /= kernel.sum()
        rows = np.repeat(np.arange(len(self.kept)), 2 * reach + 1)
        columns = (self.kept[:, None] + np.arange(-reach, reach + 1)).ravel()
        weights = np.tile(kernel, len(self.kept))
        entries = [(rows, columns, weights)]
        for end, beyond in ((0, columns < 0), (count - 1, columns >= count)):
            # x(end ± i) = 2 x(end) − x(end ∓ i)
            entries.append((rows[beyond], np.full(beyond.sum(), end), 2 * weights[beyond]))
            weights = np.where(beyond, -weights, weights)
            columns = np.where(beyond, 2 * end - columns, columns)
        entries[0] = (rows, columns, weights)
        i, j, w = (np.concatenate(part) for part in zip(*entries, strict=True))
        return csr_array((w, (i, j)), shape=(len(self.kept), count))

    def compared(self, torque: ArrayLike) -> Array:
        """Filter a torque and decimate it to the samples that are compared.

        Args:
            torque: Torque along this motion [N·m or N], shape (N,) or (N, n).

        Returns:
            Filtered torque [N·m or N], shape (K,) or (K, n).
        """
        return np.asarray(self._filter @ np.ascontiguousarray(torque, dtype=float))

    def sampled(self, signal: ArrayLike) -> Array:
        """Return a signal at the samples that are compared, unfiltered.

        Args:
            signal: Any signal of this motion, shape (N,) or (N, n).

        Returns:
            Shape (K,) or (K, n), in the unit of the signal.
        """
        return np.asarray(signal)[self.kept]
