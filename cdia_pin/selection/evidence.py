"""Evidence: the cost of sets of effects by the criterion, from the normal equations of all candidates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.criterion import SelectionCriterion

Array = NDArray[np.float64]

# Prior standard deviation [unit of the parameter] that replaces an infinite one in a spectrum.
LARGEST_PRIOR = 1e6
RANK_CUTOFF = 1e-9  # eigenvalues, over the largest [1], that are rounding
SURELY = 2.0  # standard deviations from zero [1] at which a parameter counts as identifiable: 95 %


@dataclass(frozen=True, repr=False)
class SetFit:
    """A set of effects fitted together, and its cost.

    Attributes:
        chosen: Indices of the candidates, in increasing order.
        theta: Their parameters, one effect after another, shape (p,).
        chi2: Residual sum of squares, in variances of the noise [1].
        cost: chi2 plus the penalties of the effects [1].
        possible: True if the parameters are within their bounds.
        physical: True if, besides, no parameter repeats the others, and no effect reduces to a simpler one.
    """

    chosen: tuple[int, ...]
    theta: Array
    chi2: float
    cost: float
    possible: bool
    physical: bool

    def __repr__(self) -> str:
        fit = f"{len(self.theta)} parameters, chi2 {self.chi2:.4g}, cost {self.cost:.4g}, physical {self.physical}"
        return f"SetFit({len(self.chosen)} effects, {fit})"


@dataclass(eq=False, repr=False)
class Evidence:
    """The cost of sets of candidates.

    Attributes:
        equations: Normal equations of all candidates.
        criterion: What an effect must explain to be named.
        searched: Number of shapes in which each effect was looked for, by label, of all effects that compete; counted
            if omitted.
        needed: Sum of squares of each joint that an effect must explain to be named, in variances of the noise [1],
            shape (n,); the criterion's share of all samples if omitted.
    """

    equations: NormalEquations
    criterion: SelectionCriterion = field(default_factory=SelectionCriterion)
    searched: Mapping[str, int] | None = None
    needed: Array | None = None

    def __repr__(self) -> str:
        return f"Evidence({self.equations!r})"

    @property
    def effects(self) -> Sequence[Effect]:
        """The candidates."""
        return self.equations.effects

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Labels of the candidates."""
        return tuple(e.label for e in self.effects)

    @property
    def robot(self) -> RobotModel:
        """The robot."""
        return self.equations.robot

    @property
    def samples(self) -> int:
        """Number of whitened samples of all joints."""
        return self.equations.samples

    # ------------------------------------------------------------- penalties

    @cached_property
    def effective_parameters(self) -> Array:
        """Effective number of parameters of each candidate on this motion [1], shape (number of candidates,)."""
        out = []
        for effect, own in zip(self.effects, self.equations.parameters, strict=True):
            scale = np.minimum(effect.prior_scale(self.robot), LARGEST_PRIOR)
            values = np.linalg.eigvalsh(self.equations.total[own, own] * np.outer(scale, scale))
            out.append(np.sum(values > max(1.0, RANK_CUTOFF * values[-1])) + len(effect.shape))
        return np.array(out, float)

    @property
    def penalty_per_parameter(self) -> float:
        """λ, the penalty of one parameter [1]."""
        return self.criterion.per_parameter(self.equations.samples / self.robot.n)

    @cached_property
    def penalty(self) -> Array:
        """Penalty that each candidate adds to the cost of a set [1], shape (number of candidates,); see `criterion`."""
        names = max(len(set(self.labels) if self.searched is None else self.searched), 1)
        nominal = np.array([e.size for e in self.effects])
        shapes = Counter(self.labels) if self.searched is None else self.searched
        looked_for = np.array([2 * np.log(shapes[label]) for label in self.labels])
        rarity = np.array([e.plausibility.penalty for e in self.effects])
        of_parameters = self.effective_parameters * self.penalty_per_parameter
        return np.asarray(of_parameters + 2 * np.log(names) + looked_for + rarity + 0.5 * nominal)

    @cached_property
    def least_gain(self) -> Array:
        """Sum of squares that each candidate must explain in its set to be named [1], shape (number of candidates,)."""
        if self.needed is None:
            enough = self.criterion.least_share * self.equations.samples / self.robot.n
            return np.maximum(self.penalty, enough)
        of_joints = [np.median(self.needed[list(e.acts_on(self.robot))]) for e in self.effects]
        collective = [e.plausibility.collective for e in self.effects]
        return np.maximum(self.penalty, np.where(collective, 0.0, of_joints))

    # ------------------------------------------------------------- one set

    def fit(self, chosen: Sequence[int], *, bodies: bool = False) -> SetFit:
        """Fit a set of candidates together within physical bounds.

        Args:
            chosen: Indices of the candidates.
            bodies: Make rigid bodies physically consistent too. This takes a hundred times longer.
        """
        key = tuple(sorted(chosen))
        if (key, bodies) not in self._fits:
            fit = bounded_fit(self.equations, key, bodies=bodies)
            cost = fit.chi2 + self.penalty_of(key)
            self._fits[key, bodies] = SetFit(key, fit.theta, fit.chi2, cost, fit.possible, fit.physical)
        return self._fits[key, bodies]

    def simpler_set(self, fit: SetFit) -> tuple[int, ...] | None:
        """Return the set of a fit with simpler effects in the place of those that its parameters reduce to them.

        Args:
            fit: Fit of a set.

        Returns:
            Indices of the set; None if no effect reduces to another candidate.
        """
        effects = [self.effects[c] for c in fit.chosen]
        simpler = {
            c: self._index[e.simpler]
            for c, e, part in zip(
                fit.chosen, effects, ParameterBlocks.of(effects).split(fit.theta), strict=True
            )
            if not e.is_distinct(part) and e.simpler in self._index
        }
        return tuple(sorted({simpler.get(c, c) for c in fit.chosen})) if simpler else None

    def penalty_of(self, chosen: Sequence[int]) -> float:
        """Return the penalty of a set [1].

        Args:
            chosen: Indices of the candidates.
        """
        return float(self.penalty[list(chosen)].sum())

    def bound(self, chosen: Sequence[int]) -> float:
        """Return a lower bound of the cost of a set [1], much faster than a physical fit.

        Args:
            chosen: Indices of the candidates.
        """
        return self.free_chi2(chosen) + self.penalty_of(sorted(chosen))

    def free_chi2(self, chosen: Sequence[int]) -> float:
        """Return the residual sum of squares of a set whose parameters need not be physical [1].

        Args:
            chosen: Indices of the candidates.
        """
        return self.equations.optimum(tuple(sorted(chosen)))[1]

    def bounded_chi2(self, chosen: Sequence[int], near: SetFit) -> float:
        r"""Return a lower bound of chi2 of a physical fit [1], from that of a similar set and without a new program.

        At the optimum :math:`\theta^*` of the similar set, the gradient g of half of chi2 points into what is possible:
        :math:`g^T (\theta - \theta^*) \ge 0` for all possible parameters, which are a convex set for each effect. So
        a physical fit leaves no less than the minimum of :math:`\chi^2(\theta) - 2 g^T (\theta - \theta^*)`.

        Args:
            chosen: Indices of the candidates.
            near: Physical fit of a set that has some effects in common.
        """
        key = (tuple(chosen), near.chosen)
        if key not in self._bounded:
            self._bounded[key] = self._bounded_chi2(chosen, near)
        return self._bounded[key]

    def _bounded_chi2(self, chosen: Sequence[int], near: SetFit) -> float:
        equations = self.equations
        columns = equations.columns(chosen)
        held = [c for c in near.chosen if c in set(chosen) and self.effects[c].bodies]
        if not held:
            return self.free_chi2(chosen)
        pull, start = np.zeros(len(columns)), np.zeros(len(columns))
        gradient = self._gradient(near)
        for c in held:
            own, of_near = equations.own(chosen, c), equations.own(near.chosen, c)
            pull[own], start[own] = gradient[of_near], near.theta[of_near]
        right = equations.total[columns, -1] + pull
        theta = ScaledGram.of(equations.with_prior(chosen)).solve(right)
        return equations.chi2(columns, theta) - 2.0 * float(pull @ (theta - start))

    def _gradient(self, fit: SetFit) -> Array:
        """Return the gradient of half of chi2 and prior at a fit, shape (p,)."""
        columns = self.equations.columns(fit.chosen)
        return np.asarray(
            self.equations.with_prior(fit.chosen) @ fit.theta - self.equations.total[columns, -1]
        )

    def identifiable_parameters(self, fit: SetFit, one: int) -> int:
        """Return how many parameters of one effect of a fit are identifiable: they differ significantly from zero.

        Args:
            fit: Fit of a set.
            one: Index of one candidate of the set.
        """
        deviation = np.sqrt(np.abs(np.diag(self.equations.covariance(fit.chosen, one))))
        return int(np.sum(np.abs(fit.theta[self.equations.own(fit.chosen, one)]) > SURELY * deviation))

    def gains(self, chosen: Sequence[int], *, bounded: bool = False) -> Array:
        """Return the gain of each candidate: by how much it would lower chi2 of a set [1].

        Args:
            chosen: Indices of the set.
            bounded: Leave the parameters of each candidate within their bounds.

        Returns:
            Shape (number of candidates,).
        """
        key = tuple(sorted(chosen))
        if (key, bounded) not in self._gains:
            self._gains[key, bounded] = self.equations.gains(key, bounded=bounded)
        return self._gains[key, bounded]

    @cached_property
    def _index(self) -> dict[Effect | None, int]:
        return {e: i for i, e in enumerate(self.effects)}

    @cached_property
    def _bounded(self) -> dict[tuple[tuple[int, ...], tuple[int, ...]], float]:
        return {}

    @cached_property
    def _gains(self) -> dict[tuple[tuple[int, ...], bool], Array]:
        return {}

    @cached_property
    def _fits(self) -> dict[tuple[tuple[int, ...], bool], SetFit]:
        return {}


def needed_gain(left: Array, residual_rms: Array, smallest: Array, least_share: float) -> Array:
    """Return the sum of squares of each joint that an effect must explain to be named.

    The effect must lower the residual by a visible share, and its torque must matter compared with the joint's own.

    Args:
        left: Residual sum of squares of the present model, in variances of the noise [1], shape (n,).
        residual_rms: RMS residual of the present model [N·m or N], shape (n,).
        smallest: RMS torque of an effect that matters [N·m or N], shape (n,).
        least_share: Share of the residual that is visible [1].

    Returns:
        Sum of squares [1], shape (n,).
    """
    return left * np.maximum(least_share, (smallest / np.maximum(residual_rms, 1e-12)) ** 2)
