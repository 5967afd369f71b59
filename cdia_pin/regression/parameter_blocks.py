"""Parameter blocks: the positions of the parameters of several effects in one vector."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class _Sized(Protocol):
    @property
    def size(self) -> int: ...


@dataclass(frozen=True, repr=False)
class ParameterBlocks:
    """The layout of a parameter vector θ that holds one block after another.

    Attributes:
        sizes: Number of parameters of each block.
    """

    sizes: tuple[int, ...]

    def __repr__(self) -> str:
        return f"ParameterBlocks({len(self)} blocks, {self.total} parameters)"

    @classmethod
    def of(cls, effects: Iterable[_Sized]) -> Self:
        """Return the layout with one block per effect.

        Args:
            effects: The effects, in the order of their blocks; their sizes are read.
        """
        return cls(tuple(e.size for e in effects))

    def __len__(self) -> int:
        return len(self.sizes)

    def __getitem__(self, block: int) -> slice:
        return slice(int(self._ends[block]) - self.sizes[block], int(self._ends[block]))

    def __iter__(self) -> Iterator[slice]:
        return (self[k] for k in range(len(self)))

    @property
    def total(self) -> int:
        """Number of all parameters P."""
        return sum(self.sizes)

    def indices(self, chosen: Sequence[int]) -> Indices:
        """Return the positions of the parameters of some blocks in θ.

        Args:
            chosen: Indices of the blocks.

        Returns:
            Indices into θ, block by block in the order given, shape (sum of their sizes,).
        """
        parts = [self._positions[k] for k in chosen]
        return np.concatenate(parts) if parts else np.zeros(0, int)

    def split(self, theta: Array) -> list[Array]:
        """Return each block's part of a vector.

        Args:
            theta: All parameters, shape (P,).

        Returns:
            Views of the parts, shape (size of the block,) each.
        """
        return [theta[part] for part in self]

    @cached_property
    def _positions(self) -> list[Indices]:
        return [np.arange(s.start, s.stop) for s in self]

    @cached_property
    def _ends(self) -> Indices:
        return np.cumsum(self.sizes, dtype=int)
