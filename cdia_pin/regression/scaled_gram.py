"""A scaled Gram matrix: symmetric normal equations are scaled to a unit diagonal before they are solved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALLEST_DIAGONAL = 1e-300  # guard against division by zero, in the matrix's own units


@dataclass(frozen=True, eq=False, repr=False)
class ScaledGram:
    r"""A symmetric matrix :math:`A = D^{-1} S D^{-1}` with :math:`D = \mathrm{diag}(A)^{-1/2}`.

    Parameters have different units. The scaled matrix S has none, so that its condition number depends on the data
    alone.

    Attributes:
        matrix: S, shape (P, P).
        unit: Diagonal of D, shape (P,).
    """

    matrix: Array
    unit: Array

    def __repr__(self) -> str:
        return f"ScaledGram({len(self.unit)} parameters)"

    @classmethod
    def of(cls, gram: Array, ridge: float = 0.0) -> Self:
        """Scale a matrix.

        Args:
            gram: A, symmetric, shape (P, P).
            ridge: Added to the diagonal of S [1].
        """
        unit = 1.0 / np.sqrt(np.maximum(np.diag(gram), SMALLEST_DIAGONAL))
        matrix = gram * np.outer(unit, unit)
        return cls(matrix + ridge * np.eye(len(unit)) if ridge else matrix, unit)

    def solve(self, right: Array) -> Array:
        """Return x of A x = b.

        Args:
            right: b, shape (P,) or (P, m).

        Returns:
            x, shape as b; the smallest one, in units of the diagonal, where A is singular.
        """
        from scipy.linalg.lapack import dposv

        if not right.size:
            return np.zeros_like(right)
        unit = self.unit if right.ndim == 1 else self.unit[:, None]
        _, x, failed = dposv(self.matrix.T, unit * right)  # by Cholesky; the transpose has LAPACK's order
        if failed:
            x = np.linalg.pinv(self.matrix, hermitian=True) @ (unit * right)
        return np.asarray(unit * x)

    def inverse(self) -> Array:
        """Return the inverse of A, shape (P, P)."""
        return np.asarray(self._scaled_inverse * self._units)

    def pseudo_inverse(self, cutoff: float) -> Array:
        """Return the pseudo-inverse of A.

        Args:
            cutoff: Eigenvalues of S below this share of the largest count as zero [1].

        Returns:
            Shape (P, P).
        """
        return np.asarray(np.linalg.pinv(self.matrix, rcond=cutoff, hermitian=True) * self._units)

    @property
    def inflation(self) -> Array:
        """Variance of each parameter over that without the other parameters [1], shape (P,)."""
        try:
            return np.diag(self._scaled_inverse)
        except np.linalg.LinAlgError:  # a parameter that exactly repeats others has no finite variance
            return np.full(len(self.unit), np.inf)

    @cached_property
    def _scaled_inverse(self) -> Array:
        return np.asarray(np.linalg.inv(self.matrix))

    @property
    def _units(self) -> Array:
        return np.outer(self.unit, self.unit)
