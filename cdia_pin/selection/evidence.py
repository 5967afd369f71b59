"""Evidence for sets of effects, from the normal equations of all candidates at once.

In whitened residuals y ≈ X θ + white noise of unit variance, so the cost of a set of effects is the sum of squares
it leaves plus a price for each parameter. All of it follows from XᵀX and Xᵀy, formed once: a set costs one small
solve, and the gain of every candidate beside a set one matrix product.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.physical_consistency import consistent_parameters
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

PRICE_PER_PARAMETER = 4.0  # beside the log of the samples: parsimony between nested effects
PARAMETER_WORTH = 0.012  # share of one joint's sum of squares that a parameter must explain beside its rivals
WORTH = 0.1  # least share of what is left of a joint that an effect must explain to be worth a name
MOST_INFLATION = 1e5  # of a parameter's variance by the others, beyond which it repeats them
REPAIRS = 4  # rounds of holding unphysical parameters at their nearest physical value


@dataclass(frozen=True)
class Fit:
    """A set of effects fitted together.

    Attributes:
        chosen: Indices of the candidates.
        theta: Their parameters one after another, physical unless ``physical`` is false.
        chi2: Sum of squares left, in variances of the noise [1].
        cost: chi2 plus the price of the parameters [1].
        possible: Whether the parameters are within their bounds.
        physical: Whether they are, none repeats the others, and each effect is more than a simpler one.
    """

    chosen: tuple[int, ...]
    theta: Array
    chi2: float
    cost: float
    possible: bool
    physical: bool


@dataclass
class Evidence:
    """Normal equations of all candidates, in blocks of time.

    Attributes:
        robot: The robot, for physical bounds.
        effects: The candidates.
        blocks: XᵀX of each block with y as its last column, shape (B, P + 1, P + 1).
        samples: Whitened samples of all joints.
        searched: In how many shapes each candidate, by label, was looked for.
        needed: Sum of squares of each joint that an effect must explain to be worth a name [1], shape (n,).
    """

    robot: RobotModel
    effects: Sequence[Effect]
    blocks: Array
    samples: int
    searched: Mapping[str, int] | None = None
    needed: Array | None = None

    def __post_init__(self) -> None:
        ends = np.cumsum([e.size for e in self.effects])
        self.spans = [np.arange(end - e.size, end) for e, end in zip(self.effects, ends, strict=True)]
        self._bounds = [e.bounds(self.robot) for e in self.effects]
        self._fits: dict[tuple[tuple[int, ...], bool], Fit] = {}
        self._free: dict[tuple[int, ...], tuple[Array, float]] = {}

    @cached_property
    def total(self) -> Array:
        """Sum of the blocks, shape (P + 1, P + 1)."""
        return self.blocks.sum(axis=0)

    @cached_property
    def scale(self) -> Array:
        """Norm of each column, to compare columns of different units, shape (P,)."""
        return np.sqrt(np.maximum(np.diag(self.total)[:-1], 1e-300))

    @cached_property
    def prior(self) -> Array:
        """Precision of the prior on each parameter, shape (P,)."""
        weak = 1e-10 * self.scale**2 + 1e-12
        return weak + 1.0 / self.prior_scale**2

    @cached_property
    def prior_scale(self) -> Array:
        """Size of each parameter that would surprise nobody, shape (P,)."""
        return np.concatenate([np.zeros(0), *(e.prior_scale(self.robot) for e in self.effects)])

    @cached_property
    def freedom(self) -> Array:
        """Parameters of each candidate that the motion tells about [1], shape (number of candidates,)."""
        out = []
        for effect, span in zip(self.effects, self.spans, strict=True):
            scale = np.minimum(effect.prior_scale(self.robot), 1e6)
            gram = self.total[np.ix_(span, span)] * np.outer(scale, scale)
            values = np.linalg.eigvalsh(gram)
            out.append(np.sum(values > max(1.0, 1e-9 * values[-1])) + len(effect.shape))
        return np.array(out, float)

    @property
    def price_per_parameter(self) -> float:
        """What a parameter must gain beside its rivals [1]."""
        own = self.samples / self.robot.n  # of one joint
        return max(float(np.log(max(own, 2.0))) + PRICE_PER_PARAMETER, PARAMETER_WORTH * own)

    @cached_property
    def price(self) -> Array:
        """What each candidate must gain to be worth naming [1], shape (number of candidates,)."""
        names = max(len({e.label for e in self.effects}), 1)
        sizes = np.array([e.size for e in self.effects])
        shapes = Counter(e.label for e in self.effects) if self.searched is None else self.searched
        looked = np.array([2 * np.log(shapes[e.label]) for e in self.effects])
        rare = np.array([e.plausibility.penalty for e in self.effects])
        return self.freedom * self.price_per_parameter + 2 * np.log(names) + looked + rare + 0.5 * sizes

    @cached_property
    def least_gain(self) -> Array:
        """What each candidate must explain beside the others of its set, significant and worth a name [1]."""
        if self.needed is None:
            return np.maximum(self.price, WORTH * self.samples / self.robot.n)
        of_joints = [np.median(self.needed[list(e.acts_on(self.robot))]) for e in self.effects]
        collective = [e.plausibility.collective for e in self.effects]
        return np.maximum(self.price, np.where(collective, 0.0, of_joints))

    # ------------------------------------------------------------- one set

    def fit(self, chosen: Sequence[int], *, bodies: bool = False) -> Fit:
        """Fit a set of candidates together, holding parameters at the bounds that they would pass.

        Args:
            chosen: Indices of the candidates.
            bodies: Whether rigid bodies are made physically consistent too, which takes a hundred times longer.
        """
        key = tuple(sorted(chosen))
        if (key, bodies) not in self._fits:
            self._fits[key, bodies] = self._fit(key, bodies)
        return self._fits[key, bodies]

    def bound(self, chosen: Sequence[int]) -> float:
        """Return a cost that no physical fit of a set can be below, much sooner than the fit itself [1]."""
        key = tuple(sorted(chosen))
        return self._optimum(key)[1] + float(self.price[list(key)].sum())

    def free_chi2(self, chosen: Sequence[int]) -> float:
        """Return the sum of squares that a set leaves if its parameters need not be physical [1]."""
        return self._optimum(tuple(sorted(chosen)))[1]

    def _optimum(self, chosen: tuple[int, ...]) -> tuple[Array, float]:
        """Return the best parameters of a set, physical or not, and the sum of squares they leave."""
        if chosen not in self._free:
            columns = self.columns(chosen)
            theta = self._solve(self.total, columns, np.ones(len(columns), bool), np.zeros(len(columns)))
            self._free[chosen] = (theta, self._chi2(self.total, columns, theta))
        return self._free[chosen]

    def _fit(self, chosen: tuple[int, ...], bodies: bool) -> Fit:
        columns = self.columns(chosen)
        price = float(self.price[list(chosen)].sum())
        theta, _ = self._optimum(chosen)
        if chosen and not self._in_bounds(chosen, theta):
            theta = self._bounded(chosen, columns, theta)
        if bodies and not self._consistent(chosen, theta):
            effects = [self.effects[c] for c in chosen]
            gram = self.total[np.ix_(columns, columns)] + np.diag(self.prior[columns])
            theta = consistent_parameters(gram, self.total[columns, -1], effects, self.robot)
        chi2 = self._chi2(self.total, columns, theta)
        possible = self._in_bounds(chosen, theta)
        physical = possible and not self._is_redundant(columns) and self._is_distinct(chosen, theta)
        return Fit(chosen, theta, chi2, chi2 + price, possible, physical)

    def _bounded(self, chosen: Sequence[int], columns: Indices, theta: Array) -> Array:
        """Return parameters within their bounds, those that would pass them held there."""
        limits = [self._bounds[c] for c in chosen]
        lower, upper = (np.concatenate(b) for b in zip(*limits, strict=True))
        free = np.ones(len(columns), bool)
        for _ in range(REPAIRS):
            inside = np.clip(theta, lower, upper)
            if not ((inside != theta) & free).any():
                break
            free &= inside == theta
            theta = self._solve(self.total, columns, free, inside)
        return np.clip(theta, lower, upper)

    def _in_bounds(self, chosen: Sequence[int], theta: Array) -> bool:
        if not chosen:
            return True
        lower, upper = (np.concatenate(b) for b in zip(*(self._bounds[c] for c in chosen), strict=True))
        return bool(np.all(theta >= lower) and np.all(theta <= upper))

    def _is_distinct(self, chosen: Sequence[int], theta: Array) -> bool:
        """Tell whether every effect of a set is more than a simpler one of the vocabulary."""
        sizes = [self.effects[c].size for c in chosen]
        parts = np.split(theta, np.cumsum(sizes)[:-1]) if sizes else []
        return all(self.effects[c].is_distinct(part) for c, part in zip(chosen, parts, strict=True))

    def _consistent(self, chosen: Sequence[int], theta: Array) -> bool:
        """Tell whether the rigid bodies of a set are possible."""
        at = 0
        for c in chosen:
            effect = self.effects[c]
            if effect.bodies and not effect.is_physical(theta[at : at + effect.size], self.robot):
                return False
            at += effect.size
        return True

    def columns(self, chosen: Sequence[int]) -> Indices:
        """Return the columns of a set of candidates."""
        return np.concatenate([self.spans[c] for c in chosen]) if len(chosen) else np.zeros(0, int)

    def told_from_zero(self, fit: Fit, one: int) -> int:
        """Return how many parameters of one effect of a fit are told from zero."""
        deviation = np.sqrt(np.abs(np.diag(self.covariance(fit.chosen, one))))
        own = np.isin(self.columns(fit.chosen), self.spans[one])
        return int(np.sum(np.abs(fit.theta[own]) > 2 * deviation))

    def covariance(self, chosen: Sequence[int], one: int) -> Array:
        """Return the covariance of the parameters of one effect of a set, shape (p, p)."""
        columns = self.columns(chosen)
        gram = self.total[np.ix_(columns, columns)] + np.diag(self.prior[columns])
        unit = 1.0 / np.sqrt(np.diag(gram))
        inverse = np.linalg.pinv(gram * np.outer(unit, unit), hermitian=True) * np.outer(unit, unit)
        own = np.isin(columns, self.spans[one])
        return inverse[np.ix_(own, own)]

    def held_out(self, chosen: Sequence[int]) -> float:
        """Return the sum of squares when each block is predicted from the others, in variances of the noise."""
        columns = self.columns(tuple(sorted(chosen)))
        return float(np.sum([self._chi2(b, columns, self.without(b, sorted(chosen))) for b in self.blocks]))

    def without(self, block: Array, chosen: Sequence[int]) -> Array:
        """Return the parameters of a set fitted to all but one block, shape (P,)."""
        columns = self.columns(tuple(chosen))
        return self._solve(self.total - block, columns, np.ones(len(columns), bool), np.zeros(len(columns)))

    def _solve(self, gram: Array, columns: Indices, free: Mask, start: Array) -> Array:
        theta = np.where(free, 0.0, start)
        at = columns[free]
        if len(at):
            right = gram[at, -1] - gram[np.ix_(at, columns[~free])] @ start[~free]
            matrix = gram[np.ix_(at, at)] + np.diag(self.prior[at])
            unit = 1.0 / np.sqrt(np.diag(matrix))
            theta[free] = unit * np.linalg.solve(matrix * np.outer(unit, unit), unit * right)
        return theta

    @staticmethod
    def _chi2(gram: Array, columns: Indices, theta: Array) -> float:
        v = np.append(theta, -1.0)
        at = np.append(columns, len(gram) - 1)
        return float(v @ gram[np.ix_(at, at)] @ v)

    def _is_redundant(self, columns: Indices) -> bool:
        """Tell whether a parameter does what others of the set do already, as two levels of friction would."""
        gram = self.total[np.ix_(columns, columns)] + np.diag(self.prior[columns])
        unit = 1.0 / np.sqrt(np.diag(gram))
        inflation = np.diag(np.linalg.inv(gram * np.outer(unit, unit)))
        lone = np.isinf(
            self.prior_scale[columns]
        )  # the parameters of a body repeat each other, and have a prior
        return bool((inflation[lone] > MOST_INFLATION).any())

    # ------------------------------------------------------------- every candidate beside a set

    def gains(self, chosen: Sequence[int]) -> Array:
        """Return by how much each candidate would lower chi2 beside a set [1], shape (number of candidates,)."""
        rest = self.total
        at = self.columns(chosen)
        if len(at):
            matrix = rest[np.ix_(at, at)] + np.diag(self.prior[at])
            unit = 1.0 / np.sqrt(np.diag(matrix))
            solved = unit[:, None] * np.linalg.solve(
                matrix * np.outer(unit, unit), unit[:, None] * rest[at, :]
            )
            rest = rest - rest[:, at] @ solved
        out = np.zeros(len(self.effects))
        for size, members in self._by_size.items():
            spans = np.array([self.spans[c] for c in members])
            gram = rest[spans[:, :, None], spans[:, None, :]]
            own = self.total[spans[:, :, None], spans[:, None, :]]
            right = rest[spans, -1]
            # a column that the set explains already to one part in 10⁵ adds nothing but rounding
            diagonal = self.prior[spans] + 1e-5 * np.einsum("cii->ci", own)
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


def needed_gain(left: Array, residual_rms: Array, smallest: Array) -> Array:
    """Return what an effect must explain of each joint to be worth a name.

    It must lower what is left by a share that can be seen, and give a torque that matters beside the joint's own.

    Args:
        left: Sum of squares that the present model leaves, in variances of the noise [1], shape (n,).
        residual_rms: RMS residual of the present model [N·m or N], shape (n,).
        smallest: RMS torque of an effect that matters [N·m or N], shape (n,).

    Returns:
        Sum of squares [1], shape (n,).
    """
    return left * np.maximum(WORTH, (smallest / np.maximum(residual_rms, 1e-12)) ** 2)
