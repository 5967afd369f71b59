r"""Evidence by blocks of time: each block is predicted from all others.

Residuals of measured arms are not noise: they repeat with the posture, and neighbouring samples tell the same thing.
Blocks of time are nearly independent of each other. So what an effect explains is measured on blocks that its fit did
not see, and the covariance of its parameters comes from leaving out one block at a time, the jackknife [Efron1982]:

.. math::

    V = \frac{B - 1}{B} \sum_b (\hat\theta_{(b)} - \hat\theta) (\hat\theta_{(b)} - \hat\theta)^T

The common structure is fitted again without each block too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.normal_equations import REPEATED
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.regression.shared_parameters import RIDGE, SharedRegression
from cdia_pin.regression.time_blocks import Block
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
E = TypeVar("E", bound=Effect)

# Sum of squares of an effect beside others over that without them [1], at least; a division by zero is none.
LEAST_POWER = 1e-12
NEGLIGIBLE = 1e-9  # added to a covariance, over its mean variance [1], so that it can be inverted


@dataclass(frozen=True, repr=False)
class BlockFits:
    """Each effect added to a set, fitted without one block of time at a time.

    Attributes:
        theta: Parameters of each effect from all blocks, shape (p,) each.
        certainty: Estimate over its standard deviation, root mean square over the parameters [1], shape (C,).
        gains: What each effect explains of each block when that block is left out, in units of what is left [1],
            shape (C, B).
    """

    theta: tuple[Array, ...]
    certainty: Array
    gains: Array

    def __repr__(self) -> str:
        return f"BlockFits({len(self.theta)} effects, {self.gains.shape[1]} blocks)"

    @property
    def gain(self) -> Array:
        """What each effect explains of all blocks [1], shape (C,)."""
        return np.asarray(self.gains.sum(axis=1))


@dataclass(frozen=True, repr=False)
class BlockEvidence(Generic[E]):
    """Normal equations of effects, after the common structure is taken out, without and of each block.

    Attributes:
        effects: The effects, in the order of their columns.
        training: [X y]ᵀ[X y] of all blocks but one, shape (B, P + 1, P + 1).
        unseen: [X y]ᵀ[X y] of that block, shape (B, P + 1, P + 1).
        total: [X y]ᵀ[X y] of all blocks, shape (P + 1, P + 1).
        norms: Sum of squares of each column before the common structure is taken out [1/unit²], shape (P,).
        prior: Precision of the prior on each parameter [1/unit²], shape (P,).
    """

    effects: tuple[E, ...]
    training: Array
    unseen: Array
    total: Array
    norms: Array
    prior: Array

    def __repr__(self) -> str:
        return f"BlockEvidence({len(self.effects)} effects, {len(self.training)} blocks)"

    @classmethod
    def of(
        cls,
        effects: Sequence[E],
        regression: SharedRegression,
        blocks: Sequence[Block],
        robot: RobotModel,
    ) -> Self:
        """Compute the normal equations without each block.

        Args:
            effects: The effects that are asked for; their columns are the last of the regression.
            regression: Columns of the common structure, then of the effects.
            blocks: Samples of each block.
            robot: The arm, for the prior of each effect.
        """
        first = len(regression.precision) - sum(e.size for e in effects)
        grams = [regression.gram_of(block) for block in blocks]
        whole = np.sum(grams, axis=0)
        prior = np.diag(regression.precision[:first])
        training, unseen = [], []
        for block in grams:
            rest = whole - block
            common = ScaledGram.of(rest[:first, :first] + prior, RIDGE).solve(rest[:first, first:])
            training.append(rest[first:, first:] - rest[first:, :first] @ common)
            unseen.append(
                _left_of(block[first:, first:], block[first:, :first], block[:first, :first], common)
            )
        common = ScaledGram.of(whole[:first, :first] + prior, RIDGE).solve(whole[:first, first:])
        total = whole[first:, first:] - whole[first:, :first] @ common
        norms = np.maximum(np.diag(whole)[first:-1], 1e-300)
        scale = np.concatenate([np.zeros(0), *(e.prior_scale(robot) for e in effects)])
        return cls(tuple(effects), np.array(training), np.array(unseen), total, norms, 1.0 / scale**2)

    @cached_property
    def parameters(self) -> ParameterBlocks:
        """Position of the parameters of each effect."""
        return ParameterBlocks.of(self.effects)

    def unexplained(self, chosen: Sequence[int]) -> Array:
        """Return what a set leaves of each block when that block is left out [1], shape (B,).

        Args:
            chosen: Indices of the set.
        """
        return np.asarray(self._beside(chosen)[1][:, -1, -1])

    def fits(self, chosen: Sequence[int]) -> BlockFits:
        """Return the fit of each effect beside a set, and what it explains; zero for members of the set.

        Args:
            chosen: Indices of the set.
        """
        key = tuple(sorted(chosen))
        if key not in self._fits:
            self._fits[key] = self._fitted(key)
        return self._fits[key]

    def _fitted(self, chosen: tuple[int, ...]) -> BlockFits:
        training, unseen, total = self._beside(chosen)
        count, blocks = len(self.effects), len(training)
        thetas: list[Array] = [np.zeros(e.size) for e in self.effects]
        certainty, gains = np.zeros(count), np.zeros((count, blocks))
        for size, members in self._by_size.items():
            own = np.array([self.parameters.indices([c]) for c in members])
            rows, columns = own[:, :, None], own[:, None, :]
            ridge = (REPEATED * self.norms[own] + self.prior[own])[:, None, :] * np.eye(size)
            right = training[:, own, -1]
            theta = np.linalg.solve(training[:, rows, columns] + ridge, right[..., None])[..., 0]
            whole = total[rows, columns] + ridge
            best = np.linalg.solve(whole, total[own, -1][..., None])[..., 0]
            gains[members] = 2 * np.einsum("bcp,bcp->cb", theta, unseen[:, own, -1]) - np.einsum(
                "bcp,bcpq,bcq->cb", theta, unseen[:, rows, columns], theta
            )
            certainty[members] = _certainty(theta, best, np.sqrt(np.einsum("cpp->cp", whole)))
            for c, value in zip(members, best, strict=True):
                thetas[c] = value
        gains[list(chosen)] = certainty[list(chosen)] = 0.0
        return BlockFits(tuple(thetas), certainty, gains)

    def estimate(self, chosen: Sequence[int]) -> tuple[Array, Array]:
        """Return the parameters of a set, shape (p,), and their covariance, shape (p, p).

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        best = self._solved(self.total, at)
        moved = self.estimates(chosen) - best
        return best, (len(moved) - 1) / len(moved) * moved.T @ moved

    def estimates(self, chosen: Sequence[int]) -> Array:
        """Return the parameters of a set without each block, shape (B, p).

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        return np.array([self._solved(t, at) for t in self.training])

    def powers(self, chosen: Sequence[int]) -> Array:
        """Return the sum of squares of each column beside a set [1/unit²], shape (P,).

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        ridge = np.diag(RIDGE * self.norms[at] + self.prior[at])
        inner, across = self.total[np.ix_(at, at)] + ridge, self.total[at, :-1]
        shared = (across * ScaledGram.of(inner).solve(across)).sum(axis=0) if len(at) else 0.0
        return np.maximum(np.diag(self.total)[:-1] - shared, LEAST_POWER * self.norms)

    def _solved(self, equations: Array, at: NDArray[np.intp]) -> Array:
        ridge = np.diag(RIDGE * self.norms[at] + self.prior[at])
        return ScaledGram.of(equations[np.ix_(at, at)] + ridge).solve(equations[at, -1])

    def _beside(self, chosen: Sequence[int]) -> tuple[Array, Array, Array]:
        """Return all normal equations after a set is taken out as well."""
        at = self.parameters.indices(chosen)
        if not len(at):
            return self.training, self.unseen, self.total
        ridge = np.diag(RIDGE * self.norms[at] + self.prior[at])
        training, unseen = np.empty_like(self.training), np.empty_like(self.unseen)
        for b, (seen, block) in enumerate(zip(self.training, self.unseen, strict=True)):
            share = ScaledGram.of(seen[np.ix_(at, at)] + ridge).solve(seen[at])
            training[b] = seen - seen[:, at] @ share
            unseen[b] = _left_of(block, block[:, at], block[np.ix_(at, at)], share)
        share = ScaledGram.of(self.total[np.ix_(at, at)] + ridge).solve(self.total[at])
        return training, unseen, self.total - self.total[:, at] @ share

    @cached_property
    def _fits(self) -> dict[tuple[int, ...], BlockFits]:
        return {}

    @cached_property
    def _by_size(self) -> dict[int, list[int]]:
        out: dict[int, list[int]] = {}
        for c, effect in enumerate(self.effects):
            out.setdefault(effect.size, []).append(c)
        return out


def _left_of(own: Array, across: Array, inner: Array, share: Array) -> Array:
    """Return what is left of a block's normal equations where others, fitted without it, take their share.

    That is O − A S − (A S)ᵀ + Sᵀ I S, with one product of the size of the result.

    Args:
        own: O, normal equations of the columns that stay, shape (Q, Q).
        across: A, those of the columns that stay with the others, shape (Q, p).
        inner: I, those of the others, shape (p, p).
        share: S, the others' parameters per unit of the columns that stay, shape (p, Q).
    """
    half = (across - 0.5 * share.T @ inner) @ share
    return own - half - half.T


def _certainty(theta: Array, best: Array, norms: Array) -> Array:
    """Return the estimate over its standard deviation of several effects of equal size [1], shape (C,).

    Args:
        theta: Estimates without each block, shape (B, C, p).
        best: Estimates from all blocks, shape (C, p).
        norms: Norm of each column, to compare parameters of different units, shape (C, p).
    """
    blocks, _, size = theta.shape
    moved, scaled = (theta - best) * norms, best * norms
    covariance = (blocks - 1) / blocks * np.einsum("bcp,bcq->cpq", moved, moved)
    least = NEGLIGIBLE * np.einsum("cpp->c", covariance) / size + 1e-12
    covariance = covariance + least[:, None, None] * np.eye(size)
    wald = np.einsum("cp,cp->c", scaled, np.linalg.solve(covariance, scaled[..., None])[..., 0])
    return np.asarray(np.sqrt(np.maximum(wald, 0.0) / size))
