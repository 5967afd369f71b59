"""Whitening: residuals become innovations, which are independent and have unit variance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.time_blocks import Block

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Whitening:
    """The noise of each joint, the samples that count, and blocks of time.

    Attributes:
        noise: One model per joint.
        used: Samples that count, shape (K, n).
        blocks: Samples of each block of time.
    """

    noise: tuple[NoiseModel, ...]
    used: NDArray[np.bool_]
    blocks: Sequence[Block]

    def __repr__(self) -> str:
        return f"Whitening({len(self.noise)} joints, {len(self.used)} samples, {len(self.blocks)} blocks)"

    @classmethod
    def of(cls, experiment: Experiment, noise: Sequence[NoiseModel], blocks: Sequence[Block]) -> Whitening:
        """Combine an experiment's informative samples with the noise of its joints.

        Args:
            experiment: The conditioned logs, K compared samples.
            noise: One model per joint.
            blocks: Samples of each block of time.
        """
        return cls(tuple(noise), experiment.informative, blocks)

    @property
    def samples(self) -> int:
        """Number of innovations that count, over all joints."""
        return sum(int((self.used[:, j] & m.kept).sum()) for j, m in enumerate(self.noise))

    def every(self, signal: Array) -> Array:
        """Whiten a signal of all joints.

        Args:
            signal: Torque [N·m or N], shape (K, n).

        Returns:
            Innovations in units of their standard deviation [1], shape (K, n).
        """
        return np.column_stack([self.joint(j, own) for j, own in enumerate(signal.T)])

    def joint(self, j: int, signal: Array) -> Array:
        """Whiten a signal of one joint.

        Samples that do not count are set to zero before, so that friction near rest does not reach later samples, and
        again after.

        Args:
            j: Index of the joint.
            signal: Torque [N·m or N] or columns of torque, shape (K, …).

        Returns:
            Innovations in units of their standard deviation [1], shape (K, …).
        """
        used = self.used[:, j].reshape(-1, *([1] * (signal.ndim - 1)))
        return np.where(used, self.noise[j].whiten(np.where(used, signal, 0.0)), 0.0)
