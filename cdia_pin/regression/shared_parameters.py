"""Linear regression of the torques of several joints that share parameters. Each parameter has a weak prior."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.regression.time_blocks import Block
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

WEAKEST = 1e-12  # precision of a prior without information [1/unit²], so that columns of zeros can be solved
RIDGE = 1e-10  # added to a unit diagonal [1], so that columns that repeat each other can be solved


@dataclass(frozen=True, repr=False)
class ColumnGroup:
    """Columns of one set of parameters.

    Attributes:
        columns: Columns of each joint, by its index [N·m or N per unit], shape (K, p) each.
        scale: Prior standard deviation of each parameter, ``inf`` without a prior, shape (p,).
    """

    columns: dict[int, Array]
    scale: Array

    def __repr__(self) -> str:
        return f"ColumnGroup({len(self.scale)} parameters on {len(self.columns)} joints)"

    @classmethod
    def of(cls, effect: Effect, columns: Array, robot: RobotModel, scale: Array | None = None) -> Self:
        """Return the columns of an effect.

        Args:
            effect: The effect.
            columns: Its columns [N·m or N per unit], shape (K, len(acts_on), p).
            robot: The arm.
            scale: Prior standard deviation of each parameter, shape (p,); no prior if omitted.
        """
        own = {j: columns[:, i, :] for i, j in enumerate(effect.acts_on(robot))}
        return cls(own, np.full(effect.size, np.inf) if scale is None else scale)

    def torque(self, theta: Array, n: int) -> Array:
        """Return the torque for some values of the parameters [N·m or N], shape (K, n).

        Args:
            theta: The values, shape (p,).
            n: Number of joints of the arm.
        """
        out = np.zeros((len(next(iter(self.columns.values()))), n))
        for j, columns in self.columns.items():
            out[:, j] = columns @ theta
        return out


@dataclass(frozen=True, repr=False)
class SharedRegression:
    """Rows of all joints, in units of their noise.

    Attributes:
        rows: Columns of each joint, the response last [1], shape (K, m_j + 1).
        at: Positions of these columns among all parameters, the response last, shape (m_j + 1,).
        precision: Precision of the prior on each parameter [1/unit²], shape (P,).
    """

    rows: tuple[Array, ...]
    at: tuple[Indices, ...]
    precision: Array

    def __repr__(self) -> str:
        return f"SharedRegression({len(self.precision)} parameters, {len(self.rows)} joints)"

    @classmethod
    def of(
        cls, groups: Sequence[ColumnGroup], response: Array, scaled: Callable[[int, Array], Array]
    ) -> Self:
        """Stack columns.

        Args:
            groups: Columns of each set of parameters, in the order of the parameters.
            response: Torque of each joint [N·m or N], shape (K, n).
            scaled: Function of a joint's index and columns (K, …) that divides them by the joint's noise.
        """
        blocks = ParameterBlocks(tuple(len(g.scale) for g in groups))
        rows, at = [], []
        for j in range(response.shape[1]):
            own = [(g.columns[j], block) for g, block in zip(groups, blocks, strict=True) if j in g.columns]
            rows.append(scaled(j, np.column_stack([*(x for x, _ in own), response[:, j]])))
            places = (np.arange(block.start, block.stop) for _, block in own)
            at.append(np.concatenate([*places, [blocks.total]]).astype(int))
        scale = np.concatenate([np.zeros(0), *(g.scale for g in groups)])
        return cls(tuple(rows), tuple(at), WEAKEST + 1.0 / scale**2)

    @cached_property
    def gram(self) -> Array:
        """XᵀX of all joints with the response as last column, shape (P + 1, P + 1)."""
        return self.gram_of(slice(None))

    def gram_of(self, samples: Block | Mask) -> Array:
        """Return XᵀX of some samples of all joints with the response as last column, shape (P + 1, P + 1).

        Args:
            samples: The samples; True for those of each joint, shape (K, n), where they differ.
        """
        out = np.zeros((len(self.precision) + 1,) * 2)
        for j, (rows, at) in enumerate(zip(self.rows, self.at, strict=True)):
            x = rows[samples[:, j] if isinstance(samples, np.ndarray) and samples.ndim > 1 else samples]
            there = x.any(axis=0)  # what differs between logs is zero in half of them
            x, own = x[:, there], at[there]
            out[np.ix_(own, own)] += x.T @ x
        return out

    def theta(self) -> Array:
        """Return the parameters that explain the response best, shape (P,)."""
        return np.asarray(self._inverse(len(self.precision)) @ self.gram[:-1, -1])

    def residual(self) -> tuple[Array, Array]:
        """Return the residual in units of the noise (K, n), and the effective number of parameters per joint (n,)."""
        inverse = self._inverse(len(self.precision))
        against = np.append(-inverse @ self.gram[:-1, -1], 1.0)
        left = np.column_stack([rows @ against[at] for rows, at in zip(self.rows, self.at, strict=True)])
        own = zip(self.rows, self.at, strict=True)
        used = [np.sum((x[:, :-1].T @ x[:, :-1]) * inverse[np.ix_(at[:-1], at[:-1])]) for x, at in own]
        return left, np.array(used, float)

    def beside(self, first: int) -> Array:
        """Return XᵀX of the other columns after the first are taken out, the response last.

        Args:
            first: Number of the first parameters.

        Returns:
            Shape (P − first + 1, P − first + 1).
        """
        explained = self._inverse(first) @ self.gram[:first, first:]
        return np.asarray(self.gram[first:, first:] - self.gram[first:, :first] @ explained)

    def _inverse(self, first: int) -> Array:
        """Return the inverse of the normal equations of the first parameters."""
        matrix = self.gram[:first, :first] + np.diag(self.precision[:first])
        return ScaledGram.of(matrix, RIDGE).inverse()
