"""Whitening: residuals become innovations, which are independent and have unit variance."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.noise import NoiseModel

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Whitening:
    """The noise of each joint, the samples that count, and contiguous blocks of time.

    Attributes:
        noise: One model per joint.
        used: Samples that count, shape (K, n).
        edges: First sample of each block and the end, shape (B + 1,).
    """

    noise: tuple[NoiseModel, ...]
    used: NDArray[np.bool_]
    edges: NDArray[np.intp]

    def __repr__(self) -> str:
        return f"Whitening({len(self.noise)} joints, {len(self.used)} samples, {len(self.edges) - 1} blocks)"

    @classmethod
    def of(cls, experiment: Experiment, noise: Sequence[NoiseModel], edges: NDArray[np.intp]) -> Whitening:
        """Combine an experiment's informative samples with the noise of its joints.

        Args:
            experiment: The conditioned logs, K compared samples.
            noise: One model per joint.
            edges: First sample of each block and the end, shape (B + 1,).
        """
        return cls(tuple(noise), experiment.informative, edges)

    @property
    def samples(self) -> int:
        """Number of innovations that count, over all joints."""
        return sum(int((self.used[:, j] & m.kept).sum()) for j, m in enumerate(self.noise))

    @property
    def blocks(self) -> Iterator[slice]:
        """The samples of each block of time."""
        return (slice(int(start), int(stop)) for start, stop in itertools.pairwise(self.edges))

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
