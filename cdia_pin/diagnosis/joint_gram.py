"""The Gram matrix of a joint's filtered columns and residual, of which the kernels keep the upper triangle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
