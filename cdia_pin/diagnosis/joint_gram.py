"""The Gram matrix of a joint's filtered columns and residual, of which the kernels keep the upper triangle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RIDGE = 1e-6  # [1], added to a unit diagonal: far below what a motion tells, far above rounding
TINY = 1e-200  # energy of a column that was never excited


class GramParts(NamedTuple):
    """The Gram matrix of [y; r], taken apart.

    Attributes:
        columns: Σ y yᵀ, both triangles, shape (P, P).
        right: Σ y r, shape (P,).
        energy: Σ r² [(N·m)² or N²].
    """

    columns: Array
    right: Array
    energy: float

    def left(self, theta: Array) -> float:
        """Return Σ (r − θᵀy)², what parameters leave of the residual [(N·m)² or N²].

        Args:
            theta: Parameters, shape (P,).
        """
        return float(self.energy - 2 * theta @ self.right + theta @ self.columns @ theta)


def gram_parts(gram: Array, width: int) -> GramParts:
    """Return the parts of a Gram matrix that belong to its first columns and the residual.

    Args:
        gram: Gram matrix of [y; r], upper triangle, the residual last, shape (P + 1, P + 1) or larger.
        width: P, number of columns.
    """
    return GramParts(symmetric(gram[:width, :width]), gram[:width, -1], gram[-1, -1])


def symmetric(gram: Array) -> Array:
    """Return a matrix whose upper triangle is kept, with both triangles, shape (p, p).

    Args:
        gram: The matrix; its lower triangle does not count, shape (p, p).
    """
    upper = np.triu(gram)
    return np.asarray(upper + np.triu(upper, 1).T)


def ridge_inverse(gram: Array, ridge: float = RIDGE) -> Array:
    """Return the inverse of normal equations scaled to a unit diagonal with a ridge, in their own units.

    Columns may repeat each other, or may not have been excited at all; neither fails.

    Args:
        gram: Normal equations, both triangles, shape (..., p, p).
        ridge: Added to the unit diagonal [1].
    """
    diagonal = np.einsum("...pp->...p", gram)
    unit = 1.0 / np.sqrt(np.where(diagonal > TINY, diagonal, 1.0))
    scaled = gram * unit[..., :, None] * unit[..., None, :]
    inverse = np.linalg.inv(scaled + ridge * np.eye(gram.shape[-1]))
    return np.asarray(inverse * unit[..., :, None] * unit[..., None, :])
