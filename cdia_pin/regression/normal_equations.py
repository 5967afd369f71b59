r"""Normal equations of effects, in blocks of time.

The whitened residual is :math:`y = X \theta + e` with white noise e of unit variance. Everything about a set of effects
follows from :math:`X^T X` and :math:`X^T y`, which are computed once. The fit of a set then takes one small solve, and
the gains of all other effects one matrix product.
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

# Precision of every prior over the sum of squares of the column [1], so that XᵀX can be inverted.
WEAKEST_PRIOR = 1e-10
# Share of its sum of squares [1]; if a set leaves less of a column, the column repeats the set.
REPEATED = 1e-5
NO_CUTOFF = 1e-15  # eigenvalues of a pseudo-inverse, over the largest [1], that count as zero: rounding only


@dataclass(eq=False, repr=False)
class NormalEquations:
    """XᵀX and Xᵀy of effects.

    Attributes:
        robot: The robot, for physical bounds.
        effects: The effects whose columns are in X, in this order.
        blocks: [X y]ᵀ[X y] of each block of time, shape (B, P + 1, P + 1).
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
        """Position of the parameters of each effect in θ."""
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
        """Return the positions of the parameters of some effects in θ.

        Args:
            chosen: Indices of the effects.

        Returns:
            Shape (p,).
        """
        return self.parameters.indices(chosen)

    def with_prior(self, chosen: Sequence[int]) -> Array:
        """Return XᵀX of some effects plus the precision of their prior.

        Args:
            chosen: Indices of the effects.

        Returns:
            Shape (p, p).
        """
        at = self.columns(chosen)
        return self.total[np.ix_(at, at)] + np.diag(self.prior[at])

    def optimum(self, chosen: Sequence[int]) -> tuple[Array, float]:
        """Return the best parameters of a set, physical or not, and the residual sum of squares.

        Args:
            chosen: Indices of the effects.

        Returns:
            Parameters, shape (p,), and the residual sum of squares in variances of the noise [1].
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
        """Return the best values of some parameters, of which some may be fixed.

        Args:
            columns: Positions of the parameters in θ, shape (p,).
            free: True for parameters that are not fixed, shape (p,); all if omitted.
            held: Values of the fixed parameters, shape (p,); entries of free ones are ignored.
            gram: Normal equations to use, shape (P + 1, P + 1); those of all blocks if omitted.

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
        """Return the residual sum of squares, in variances of the noise [1].

        Args:
            columns: Positions of the parameters in θ, shape (p,).
            theta: Values of the parameters, shape (p,).
            gram: Normal equations to use, shape (P + 1, P + 1); those of all blocks if omitted.
        """
        gram = self.total if gram is None else gram
        v = np.append(theta, -1.0)
        at = np.append(columns, len(gram) - 1)
        return float(v @ gram[np.ix_(at, at)] @ v)

    def objective(self, chosen: Sequence[int], theta: Array) -> float:
        """Return what a fit minimises [1]: the residual sum of squares and the distance from the prior.

        Args:
            chosen: Indices of the effects.
            theta: Their parameters, one effect after another, shape (p,).
        """
        return self.chi2(self.columns(chosen), theta) + self.from_prior(chosen, theta)

    def from_prior(self, chosen: Sequence[int], theta: Array) -> float:
        """Return the squared distance of parameters from their prior, in its standard deviations [1].

        Args:
            chosen: Indices of the effects.
            theta: Their parameters, one effect after another, shape (p,).
        """
        return float(self.prior[self.columns(chosen)] @ theta**2)

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
        """Return a mask of the parameters of one effect among those of a set.

        Args:
            chosen: Indices of the set.
            one: Index of the effect.

        Returns:
            Shape (p of the set,).
        """
        sizes = [self.effects[c].size for c in chosen]
        return np.repeat(np.array([c == one for c in chosen], bool), np.array(sizes, int))

    def is_redundant(self, chosen: Sequence[int], most_inflation: float) -> bool:
        """Return True if a parameter repeats others of the set, as two levels of friction would.

        Args:
            chosen: Indices of the set.
            most_inflation: Variance of a parameter over that without the others, above which it repeats them [1].
        """
        inflation = ScaledGram.of(self.with_prior(chosen)).inflation
        # the parameters of a body repeat each other, but they have a prior
        without_prior = np.isinf(self.prior_scale[self.columns(chosen)])
        return bool((inflation[without_prior] > most_inflation).any())

    # ------------------------------------------------------------- blocks that are left out

    def held_out(self, chosen: Sequence[int], fitted: Array) -> float:
        """Return the held-out sum of squares, in variances of the noise [1]: each block is predicted from the others.

        Args:
            chosen: Indices of the set, in increasing order.
            fitted: Its parameters, fitted to all blocks, shape (p,).
        """
        at = self.columns(chosen)
        return float(
            np.sum([self.chi2(at, fitted + self.change_without(b, chosen), gram=b) for b in self.blocks])
        )

    def change_without(self, block: Array, chosen: Sequence[int]) -> Array:
        """Return by how much the parameters of a set change if one block is left out of their fit.

        Parameters that limits hold change as if they were free.

        Args:
            block: Normal equations of the block, shape (P + 1, P + 1).
            chosen: Indices of the set.

        Returns:
            Shape (p,).
        """
        best, _ = self.optimum(chosen)
        return self.solve(self.columns(chosen), gram=self.total - block) - best

    # ------------------------------------------------------------- every effect added to a set

    def gains(self, chosen: Sequence[int], *, bounded: bool = False) -> Array:
        """Return the gain of each effect: by how much it would lower the residual sum of squares of a set.

        Args:
            chosen: Indices of the set.
            bounded: Leave the parameters of each effect that is added within their bounds.

        Returns:
            In variances of the noise [1], zero for effects of the set, shape (number of effects,).
        """
        at, across = self.columns(chosen), self.total[self.columns(chosen)]
        # what is left of XᵀX is XᵀX − acrossᵀ explained; only the block of each effect is needed
        explained = ScaledGram.of(self.with_prior(chosen)).solve(across) if len(at) else across
        right = self.total[:, -1] - across.T @ explained[:, -1]
        out = np.zeros(len(self.effects))
        for members, spans, own, diagonal in self._by_size:
            of_effects = np.moveaxis(across[:, spans], 0, 2)  # (C, p, number of the set's parameters)
            gram = own - of_effects @ np.moveaxis(explained[:, spans], 0, 1)
            r = right[spans]
            damped = gram + np.eye(spans.shape[1]) * diagonal[:, None, :]
            theta = np.asarray(np.linalg.solve(damped, r[:, :, None])[:, :, 0], float)
            if bounded:
                lower, upper = (np.array([self.bounds[c][i] for c in members]) for i in (0, 1))
                theta = _within(lower, upper, theta, damped, r)
            out[members] = 2 * np.einsum("cp,cp->c", theta, r) - np.einsum("cp,cpq,cq->c", theta, gram, theta)
        out[list(chosen)] = 0.0
        return out

    @cached_property
    def _by_size(self) -> list[tuple[Indices, Indices, Array, Array]]:
        """Effects of equal size: indices, positions of their parameters, blocks of XᵀX, and what is added to them."""
        members: dict[int, list[int]] = {}
        for c, effect in enumerate(self.effects):
            members.setdefault(effect.size, []).append(c)
        out = []
        for of_size in members.values():
            spans = np.array([self.columns([c]) for c in of_size])
            own = self.total[spans[:, :, None], spans[:, None, :]]
            diagonal = self.prior[spans] + REPEATED * np.einsum("cii->ci", own)
            out.append((np.array(of_size), spans, own, diagonal))
        return out

    @cached_property
    def _optima(self) -> dict[tuple[int, ...], tuple[Array, float]]:
        return {}


def _within(lower: Array, upper: Array, theta: Array, gram: Array, right: Array) -> Array:
    r"""Return the least :math:`\frac12 \theta^T G \theta - r^T \theta` within bounds, of several effects.

    Parameters that would violate a bound are fixed at it.

    Args:
        lower: Smallest parameters, shape (C, p).
        upper: Largest parameters, shape (C, p).
        theta: The best without bounds, shape (C, p).
        gram: G, shape (C, p, p).
        right: r, shape (C, p).

    Returns:
        Shape (C, p).
    """
    size, free = theta.shape[1], np.ones(theta.shape, bool)
    for _ in range(size):
        inside = np.clip(theta, lower, upper)
        violated = (inside != theta) & free
        at = np.flatnonzero(violated.any(axis=1))
        if not len(at):
            break
        free &= ~violated
        held = np.where(free[at], 0.0, inside[at])
        r = np.where(free[at], right[at] - np.einsum("cpq,cq->cp", gram[at], held), held)
        both = free[at][:, :, None] & free[at][:, None, :]
        fixed = np.eye(size) * ~free[at][:, None, :]
        theta[at] = np.linalg.solve(np.where(both, gram[at], 0.0) + fixed, r[:, :, None])[:, :, 0]
    return np.clip(theta, lower, upper)
