r"""Evidence by blocks of time: each block is predicted from all others.

Residuals of measured arms are not noise: they repeat with the posture, and neighbouring samples tell the same thing.
Blocks of time are nearly independent of each other. So what an effect explains is measured on blocks that its fit did
not see, and the covariance of its parameters comes from leaving out one block at a time, the jackknife [Efron1982]:

.. math::

    V = \frac{B - 1}{B} \sum_b (\hat\theta_{(b)} - \hat\theta) (\hat\theta_{(b)} - \hat\theta)^T

The common structure is fitted again without each block too. Blocks of one log hold the same motion, and agree on what
is wrong with it. So the same is done without each quarter of the speeds (`speed_parts`). Where these show more than
noise would, a parameter is as uncertain as they say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import chain
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
Mask = NDArray[np.bool_]
E = TypeVar("E", bound=Effect)

ALL, LAST = slice(None), slice(-1, None)  # columns; the last one is the response

# Sum of squares of an effect beside others over that without them [1], at least; a division by zero is none.
LEAST_POWER = 1e-12
# Up to this it may be chance: where four parts and 32 blocks estimate the same variance, it is exceeded in one case of
# twenty. Without it, 12 of 36 effects between unlike motions of a UR5 are named exactly, with it 11.
SCATTER = 2.9  # variance by parts of the speeds over that by blocks of time [1]
# Without a part that holds nearly all that is known of a parameter, an estimate tells nothing. Without the slowest
# quarter, half of a UR10's log had 12.5 ± 29 N·m of Coulomb friction beside bristles; with this rule ± 5, as with 10
# and 30.
HARDLY_KNOWN = 20.0  # variance of a parameter without a part of the speeds, over that with it [1]
# Of a parameter whose column has a sum of squares of one [1], so that none is inverted.
LEAST_VARIANCE = 1e-12  # [1]
NO_VARIANCE = 1e-300  # of a parameter that blocks do not move [unit²], so that none is not divided by zero
NEGLIGIBLE = 1e-9  # added to a covariance, over its mean variance [1], so that it can be inverted
# Those of one body. Estimates without each of 32 blocks tell the covariance of so many. Of 20 parameters noise
# alone would seem 1.7 standard deviations from zero, of 40 more than 10,000.
TOLD_APART = 10  # parameters [1]


@dataclass(frozen=True, repr=False)
class BlockFits:
    """Each effect added to a set, fitted without one block of time at a time.

    Attributes:
        theta: Parameters of each effect from all blocks, shape (p,) each.
        certainties: Estimate over its standard deviation, root mean square over the parameters [1], shape (2, C): the
            standard deviation from blocks of time, and from the more uncertain of these and of parts of the speeds.
        gains: What each effect explains of each block when that block is left out, in units of what is left [1],
            shape (C, B).
    """

    theta: tuple[Array, ...]
    certainties: Array
    gains: Array

    def __repr__(self) -> str:
        return f"BlockFits({len(self.theta)} effects, {self.gains.shape[1]} blocks)"

    @property
    def certainty_by_time(self) -> Array:
        """The certainty by blocks of time alone [1], shape (C,)."""
        return np.asarray(self.certainties[0])

    @property
    def certainty(self) -> Array:
        """The smaller of both certainties [1], shape (C,)."""
        return np.asarray(self.certainties[-1])

    @property
    def gain(self) -> Array:
        """What each effect explains of all blocks [1], shape (C,)."""
        return np.asarray(self.gains.sum(axis=1))


@dataclass(frozen=True, repr=False)
class BlockEvidence(Generic[E]):
    """Normal equations of effects, after the common structure is taken out, without and of each block.

    Attributes:
        effects: The effects, in the order of their columns.
        training: [X y]ᵀ[X y] of all blocks but one, and then of all parts of the speeds but one, shape
            (B + parts, P + 1, P + 1).
        unseen: [X y]ᵀ[X y] of the block that is left out, shape (B, P + 1, P + 1).
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
        return f"BlockEvidence({len(self.effects)} effects, {len(self.unseen)} blocks)"

    @classmethod
    def of(
        cls,
        effects: Sequence[E],
        regression: SharedRegression,
        blocks: Sequence[Block],
        robot: RobotModel,
        parts: Sequence[Mask] = (),
    ) -> Self:
        """Compute the normal equations without each block.

        Args:
            effects: The effects that are asked for; their columns are the last of the regression.
            regression: Columns of the common structure, then of the effects.
            blocks: Samples of each block.
            robot: The arm, for the prior of each effect.
            parts: Samples of each part of the speeds of each joint, shape (K, n) each; none by default.
        """
        first = len(regression.precision) - sum(e.size for e in effects)
        grams = [regression.gram_of(block) for block in blocks]
        whole = reduce(np.add, grams)
        prior = np.diag(regression.precision[:first])
        size = len(whole) - first
        training = np.empty((len(blocks) + len(parts), size, size))
        unseen = np.empty((len(blocks), size, size))
        for k, left_out in enumerate(chain(grams, map(regression.gram_of, parts))):
            rest = whole - left_out
            common = ScaledGram.of(rest[:first, :first] + prior, RIDGE).solve(rest[:first, first:])
            training[k] = rest[first:, first:] - rest[first:, :first] @ common
            if k < len(blocks):
                inner, across = left_out[:first, :first], left_out[first:, :first]
                unseen[k] = _left_of(left_out[first:, first:], across, inner, common)
        common = ScaledGram.of(whole[:first, :first] + prior, RIDGE).solve(whole[:first, first:])
        total = whole[first:, first:] - whole[first:, :first] @ common
        norms = np.maximum(np.diag(whole)[first:-1], 1e-300)
        scale = np.concatenate([np.zeros(0), *(e.prior_scale(robot) for e in effects)])
        return cls(tuple(effects), training, unseen, total, norms, 1.0 / scale**2)

    @cached_property
    def parameters(self) -> ParameterBlocks:
        """Position of the parameters of each effect."""
        return ParameterBlocks.of(self.effects)

    @property
    def left(self) -> float:
        """What the common structure leaves of all samples [1]."""
        return float(self.total[-1, -1])

    def unexplained(self, chosen: Sequence[int]) -> Array:
        """Return what a set leaves of each block when that block is left out [1], shape (B,).

        Args:
            chosen: Indices of the set.
        """
        of_response = self._shares(chosen, LAST)
        return np.asarray(self._beside(chosen, of_response, np.array([[-1]]))[1][:, 0, 0, 0])

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
        count, blocks = len(self.effects), len(self.unseen)
        thetas: list[Array] = [np.zeros(e.size) for e in self.effects]
        certainties, gains = np.zeros((2, count)), np.zeros((count, blocks))
        shares = self._shares(chosen)
        for size, members in self._by_size.items():
            own = np.array([self.parameters.indices([c]) for c in members])
            with_response = np.column_stack([own, np.full(len(own), -1)])
            training, unseen, total = self._beside(chosen, shares, with_response)
            ridge = (REPEATED * self.norms[own] + self.prior[own])[:, None, :] * np.eye(size)
            seen = training[:, :, :-1, :-1] + ridge
            theta = np.linalg.solve(seen, training[:, :, :-1, -1:])[..., 0]
            whole = total[:, :-1, :-1] + ridge
            best = np.linalg.solve(whole, total[:, :-1, -1:])[..., 0]
            blind = theta[:blocks]  # to the block that is predicted
            gains[members] = 2 * np.einsum("bcp,bcp->cb", blind, unseen[:, :, :-1, -1]) - np.einsum(
                "bcp,bcpq,bcq->cb", blind, unseen[:, :, :-1, :-1], blind
            )
            norms = np.sqrt(np.einsum("cpp->cp", whole))  # to compare parameters of different units
            both = self._covariances((theta - best) * norms, _growth(seen[blocks:], whole))
            for certainty, covariance in zip(certainties, both, strict=True):
                certainty[members] = certainty_of(best * norms, covariance)
            for c, value in zip(members, best, strict=True):
                thetas[c] = value
        gains[list(chosen)] = certainties[:, list(chosen)] = 0.0
        return BlockFits(tuple(thetas), certainties, gains)

    def estimate(self, chosen: Sequence[int]) -> tuple[Array, Array]:
        """Return the parameters of a set, shape (p,), and their covariance, shape (p, p).

        Args:
            chosen: Indices of the set.
        """
        best, covariances = self.estimate_with_both(chosen)
        return best, covariances[-1]

    def estimate_with_both(self, chosen: Sequence[int]) -> tuple[Array, Array]:
        """Return the parameters of a set, shape (p,), and both covariances, shape (2, p, p).

        The first is from blocks of time, the second from the more uncertain of these and of parts of the speeds.

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        best = self._solved(self.total, at)
        moved = np.array([self._solved(t, at) for t in self.training]) - best
        own = np.ix_(at, at)
        known = np.array([t[own] + self._ridge(at) for t in self.training[len(self.unseen) :]])
        growth = _growth(known[:, None], (self.total[own] + self._ridge(at))[None])
        return best, np.array(self._covariances(moved[:, None], growth))[:, 0]

    def estimates(self, chosen: Sequence[int]) -> Array:
        """Return the parameters of a set without each block, shape (B, p).

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        return np.array([self._solved(t, at) for t in self.training[: len(self.unseen)]])

    def powers(self, chosen: Sequence[int]) -> Array:
        """Return the sum of squares of each column beside a set [1/unit²], shape (P,).

        Args:
            chosen: Indices of the set.
        """
        at = self.parameters.indices(chosen)
        inner, across = self.total[np.ix_(at, at)] + self._ridge(at), self.total[at, :-1]
        shared = (across * ScaledGram.of(inner).solve(across)).sum(axis=0) if len(at) else 0.0
        return np.maximum(np.diag(self.total)[:-1] - shared, LEAST_POWER * self.norms)

    def _solved(self, equations: Array, at: NDArray[np.intp]) -> Array:
        return ScaledGram.of(equations[np.ix_(at, at)] + self._ridge(at)).solve(equations[at, -1])

    def _ridge(self, at: NDArray[np.intp]) -> Array:
        return np.diag(RIDGE * self.norms[at] + self.prior[at])

    def _shares(self, chosen: Sequence[int], columns: slice = ALL) -> Array:
        """Return how a set would explain each column: its parameters without each block and part, and from all samples.

        Args:
            chosen: Indices of the set, p parameters.
            columns: Which of the columns, Q of them; all by default.

        Returns:
            Shape (B + parts + 1, p, Q).
        """
        at = self.parameters.indices(chosen)
        own, ridge, every = np.ix_(at, at), self._ridge(at), (*self.training, self.total)
        return np.array([ScaledGram.of(x[own] + ridge).solve(x[at, columns]) for x in every])

    def _beside(
        self, chosen: Sequence[int], shares: Array, own: NDArray[np.intp]
    ) -> tuple[Array, Array, Array]:
        """Return the normal equations of some groups of columns, each by itself, after a set is taken out as well.

        Args:
            chosen: Indices of the set.
            shares: How the set would explain the columns, those of the groups or all.
            own: Positions of the columns of each group, shape (G, q).

        Returns:
            Without each block and part, of each block, and of all samples, shape (…, G, q, q).
        """
        rows, columns = own[:, :, None], own[:, None, :]
        training, unseen, total = (x[..., rows, columns] for x in (self.training, self.unseen, self.total))
        at = self.parameters.indices(chosen)
        if not len(at):
            return training, unseen, total
        share, of_set = shares[..., own], at[:, None, None]
        training -= _products(self.training[:, of_set, own], share[:-1])
        blind = share[: len(unseen)]  # to the block that is predicted
        inner = self.unseen[:, at[:, None], at]
        explained = (inner @ blind.reshape(*inner.shape[:2], -1)).reshape(blind.shape)
        half = _products(self.unseen[:, of_set, own] - 0.5 * explained, blind)
        unseen -= half + half.swapaxes(-1, -2)
        return training, unseen, total - _products(self.total[of_set, own], share[-1])

    def _covariances(self, moved: Array, growth: Array) -> tuple[Array, Array]:
        """Return the covariance of the parameters of several effects by the jackknife, shape (C, p, p) each.

        The first is that of blocks of time. The second has standard deviations that are as large as parts of the speeds
        say, where these say more than noise would. A part without which a parameter is hardly known says nothing of it.

        Args:
            moved: Estimates without each block and each part less those from all samples, shape (B + parts, C, p).
            growth: Variance of each parameter without each part over that with all [1], shape (parts, C, p).
        """
        of_time, of_speed = np.split(moved, [len(self.unseen)])
        blocks, parts = len(of_time), len(of_speed)
        covariance = (blocks - 1) / blocks * np.einsum("bcp,bcq->cpq", of_time, of_time)
        if not parts:
            return covariance, covariance
        share, tells = (parts - 1) / parts, growth < HARDLY_KNOWN
        variance = share * np.sum(of_speed**2, axis=0, where=tells)
        # more than 1 if the parts tell unequally much
        by_noise = share * np.sum(growth - 1.0, axis=0, where=tells)
        ratio = variance / np.maximum(np.einsum("cpp->cp", covariance), NO_VARIANCE)
        more = np.sqrt(np.where(ratio > SCATTER * np.maximum(by_noise, 1.0), ratio, 1.0))
        return covariance, covariance * more[:, :, None] * more[:, None, :]

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


def _products(left: Array, right: Array) -> Array:
    """Return LᵀR of each group of columns, shape (…, G, q, q).

    Args:
        left: L, shape (…, p, G, q).
        right: R, shape (…, p, G, q).
    """
    return np.asarray(np.moveaxis(left, -3, -1) @ np.moveaxis(right, -3, -2))


def _growth(known: Array, whole: Array) -> Array:
    """Return the variance of each parameter without each part of the speeds over that with all [1], at least 1.

    If noise alone moves the estimates, the parts show these ratios less one: each 1 / (parts − 1) if all parts tell as
    much, and more for one that holds most of what is known, as the slowest quarter does of Stribeck friction.

    Args:
        known: Normal equations of each effect without each part, shape (parts, C, p, p).
        whole: Those of all samples, shape (C, p, p).

    Returns:
        Shape (parts, C, p).
    """
    if not len(known):
        return np.ones((0, *whole.shape[:2]))
    with np.errstate(invalid="ignore"):  # nothing is known of a parameter whose column is zero in all samples
        variance, without = np.einsum("cpp->cp", np.linalg.inv(whole)), np.linalg.inv(known)
        growth = np.einsum("kcpp->kcp", without) / variance
    return np.asarray(np.maximum(np.nan_to_num(growth, nan=1.0), 1.0))


def certainty_of(best: Array, covariance: Array) -> Array:
    """Return the estimate over its standard deviation of several effects of equal size [1], shape (C,).

    Of more parameters than one body has, each body is compared with zero by itself: what blocks tell of the covariance
    between them is noise.

    Args:
        best: Estimates, in units in which the parameters can be compared, shape (C, p).
        covariance: Their covariance in the same units, shape (C, p, p).

    Returns:
        Root mean square over the parameters.
    """
    size = best.shape[1]
    body = np.arange(size) // TOLD_APART
    least = NEGLIGIBLE * np.einsum("cpp->c", covariance) / size + LEAST_VARIANCE
    covariance = covariance * (body[:, None] == body) + least[:, None, None] * np.eye(size)
    wald = np.einsum("cp,cp->c", best, np.linalg.solve(covariance, best[..., None])[..., 0])
    return np.asarray(np.sqrt(np.maximum(wald, 0.0) / size))
