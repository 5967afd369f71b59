r"""Normal equations of effects, in blocks of time.

In whitened residuals :math:`y = X \theta + e` with white noise e of unit variance. All that is asked of a set of
effects follows from :math:`X^T X` and :math:`X^T y`, formed once: a set costs one small solve, and the gain of every
effect beside a set one matrix product.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

WEAKEST_PRIOR = 1e-10  # precision of the prior of every parameter, over its column's sum of squares [1]
REPEATED = 1e-5  # share of its sum of squares below which a column repeats a set, and shows rounding only
NO_CUTOFF = 1e-15  # eigenvalues that a pseudo-inverse takes for zero, over the largest


@dataclass(eq=False, repr=False)
class NormalEquations:
    """XᵀX and Xᵀy of effects.

    Attributes:
        robot: The robot, for physical bounds.
        effects: The effects whose columns X has, one after another.
        blocks: XᵀX of each block of time with y as the last column, shape (B, P + 1, P + 1).
        samples: Number of whitened samples of all joints.
    """

    robot: RobotModel
    effects: Sequence[Effect]
    blocks: Array
    samples: int

    def __repr__(self) -> str:
        size = f"{len(self.effects)} effects, {self.parameters.total} parameters"
        return f"NormalEquations({size}, {len(self.blocks)} blocks, {self.samples} samples)"

    @cached_property
    def parameters(self) -> ParameterBlocks:
        """Where the parameters of each effect stand."""
        return ParameterBlocks.of(self.effects)

    @cached_property
    def total(self) -> Array:
        """Sum of the blocks, shape (P + 1, P + 1)."""
        return np.asarray(self.blocks.sum(axis=0))

    @cached_property
    def scale(self) -> Array:
        """Norm of each column, to compare columns of different units, shape (P,)."""
        return np.sqrt(np.maximum(np.diag(self.total)[:-1], 1e-300))

    @cached_property
    def prior(self) -> Array:
        """Precision of the prior on each parameter, shape (P,)."""
        weak = WEAKEST_PRIOR * self.scale**2 + 1e-12
        return np.asarray(weak + 1.0 / self.prior_scale**2)

    @cached_property
    def prior_scale(self) -> Array:
        """Prior standard deviation of each parameter, shape (P,)."""
        return np.concatenate([np.zeros(0), *(e.prior_scale(self.robot) for e in self.effects)])

    @cached_property
    def bounds(self) -> list[tuple[Array, Array]]:
        """Smallest and largest physical parameters of each effect, shape (p of the effect,) each."""
        return [e.bounds(self.robot) for e in self.effects]

    # ------------------------------------------------------------- one set

    def columns(self, chosen: Sequence[int]) -> Indices:
        """Return where the parameters of some effects stand, shape (p,)."""
        return self.parameters.indices(chosen)

    def with_prior(self, chosen: Sequence[int]) -> Array:
        """Return XᵀX of some effects with the precision of their prior, shape (p, p)."""
        at = self.columns(chosen)
        return self.total[np.ix_(at, at)] + np.diag(self.prior[at])

    def optimum(self, chosen: Sequence[int]) -> tuple[Array, float]:
        """Return the best parameters of a set, physical or not, and the sum of squares that they leave.

        Args:
            chosen: Indices of the effects.

        Returns:
            Parameters, shape (p,), and the sum of squares in variances of the noise [1].
        """
        key = tuple(chosen)
        if key not in self._optima:
            columns = self.columns(key)
            theta = self.solve(columns)
            self._optima[key] = (theta, self.chi2(columns, theta))
        return self._optima[key]

    def solve(
        self,
        columns: Indices,
        free: Mask | None = None,
        held: Array | None = None,
        gram: Array | None = None,
    ) -> Array:
        """Return the best values of some parameters, with or without others that are held.

        Args:
            columns: Where the parameters stand, shape (p,).
            free: Which of them are free; all if omitted, shape (p,).
            held: Values of those that are not, shape (p,).
            gram: Normal equations to use; those of all blocks if omitted, shape (P + 1, P + 1).

        Returns:
            All of the parameters, shape (p,).
        """
        gram = self.total if gram is None else gram
        free = np.ones(len(columns), bool) if free is None else free
        start = np.zeros(len(columns)) if held is None else held
        theta = np.where(free, 0.0, start)
        at = columns[free]
        if len(at):
            right = gram[at, -1] - gram[np.ix_(at, columns[~free])] @ start[~free]
            theta[free] = ScaledGram.of(gram[np.ix_(at, at)] + np.diag(self.prior[at])).solve(right)
        return theta

    def chi2(self, columns: Indices, theta: Array, gram: Array | None = None) -> float:
        """Return the sum of squares that parameters leave, in variances of the noise [1].

        Args:
            columns: Where the parameters stand, shape (p,).
            theta: Their values, shape (p,).
            gram: Normal equations to use; those of all blocks if omitted, shape (P + 1, P + 1).
        """
        gram = self.total if gram is None else gram
        v = np.append(theta, -1.0)
        at = np.append(columns, len(gram) - 1)
        return float(v @ gram[np.ix_(at, at)] @ v)

    def covariance(self, chosen: Sequence[int], one: int) -> Array:
        """Return the covariance of the parameters of one effect of a set.

        Args:
            chosen: Indices of the set.
            one: Index of the effect.

        Returns:
            Shape (p of the effect, p of the effect).
        """
        inverse = ScaledGram.of(self.with_prior(chosen)).pseudo_inverse(NO_CUTOFF)
        own = self.own(chosen, one)
        return inverse[np.ix_(own, own)]

    def own(self, chosen: Sequence[int], one: int) -> Mask:
        """Return which of a set's parameters are those of one effect, shape (p of the set,)."""
        return np.isin(self.columns(chosen), self.columns([one]))

    def is_redundant(self, chosen: Sequence[int], most_inflation: float) -> bool:
        """Tell whether a parameter does what others of the set do already, as two levels of friction would.

        Args:
            chosen: Indices of the set.
            most_inflation: Variance of a parameter over that without the others, beyond which it repeats them [1].
        """
        inflation = ScaledGram.of(self.with_prior(chosen)).inflation
        # the parameters of a body repeat each other, and have a prior
        without_prior = np.isinf(self.prior_scale[self.columns(chosen)])
        return bool((inflation[without_prior] > most_inflation).any())

    # ------------------------------------------------------------- blocks that are left out

    def held_out(self, chosen: Sequence[int]) -> float:
        """Return the sum of squares when each block is predicted from the others, in variances of the noise [1]."""
        columns = self.columns(sorted(chosen))
        return float(
            np.sum([self.chi2(columns, self.without(b, sorted(chosen)), gram=b) for b in self.blocks])
        )

    def without(self, block: Array, chosen: Sequence[int]) -> Array:
        """Return the parameters of a set fitted to all but one block.

        Args:
            block: Normal equations of the block, shape (P + 1, P + 1).
            chosen: Indices of the set.

        Returns:
            Shape (p,).
        """
        return self.solve(self.columns(chosen), gram=self.total - block)

    def restricted(self, chosen: Sequence[int]) -> NormalEquations:
        """Return the normal equations of some of the effects alone."""
        at = np.append(self.columns(chosen), -1)
        blocks = self.blocks[:, at][:, :, at]
        return NormalEquations(self.robot, [self.effects[c] for c in chosen], blocks, self.samples)

    # ------------------------------------------------------------- every effect beside a set

    def gains(self, chosen: Sequence[int]) -> Array:
        """Return by how much each effect would lower the sum of squares beside a set.

        Args:
            chosen: Indices of the set.

        Returns:
            In variances of the noise [1], zero for the set's own, shape (number of effects,).
        """
        rest = self.total
        at = self.columns(chosen)
        if len(at):
            rest = rest - rest[:, at] @ ScaledGram.of(self.with_prior(chosen)).solve(rest[at, :])
        out = np.zeros(len(self.effects))
        for size, members in self._by_size.items():
            spans = np.array([self.columns([c]) for c in members])
            gram = rest[spans[:, :, None], spans[:, None, :]]
            own = self.total[spans[:, :, None], spans[:, None, :]]
            right = rest[spans, -1]
            diagonal = self.prior[spans] + REPEATED * np.einsum("cii->ci", own)
            theta = np.linalg.solve(gram + np.eye(size) * diagonal[:, None, :], right[:, :, None])[:, :, 0]
            out[members] = 2 * np.einsum("cp,cp->c", theta, right) - np.einsum(
                "cp,cpq,cq->c", theta, gram, theta
            )
        out[list(chosen)] = 0.0
        return out

    @cached_property
    def _by_size(self) -> dict[int, list[int]]:
        out: dict[int, list[int]] = {}
        for c, effect in enumerate(self.effects):
            out.setdefault(effect.size, []).append(c)
        return out

    @cached_property
    def _optima(self) -> dict[tuple[int, ...], tuple[Array, float]]:
        return {}
