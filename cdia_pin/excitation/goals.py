"""Goals of a motion: to show the parameters of effects, or which of two explanations is true."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.excitation.information import Information
from cdia_pin.excitation.sides import Side, separation
from cdia_pin.phrases import clipped
from cdia_pin.regression.scaled_gram import ScaledGram

Array = NDArray[np.float64]

# Eigenvalue over the largest [1], below which no motion shows a combination of parameters: rounding.
UNSEEN = 1e-10
# Share of a side's torque [1]; if the other side leaves less, the rest is the smoothing of sgn(q̇).
SAME = 1e-4
ENOUGH = 30.0  # standard deviations [1]; two explanations further apart need no better motion
WEIGHT = 3.0  # weight of the pair over that of all other effects [1], because the pair was asked for


class Goal(ABC):
    """Score of a motion."""

    @property
    @abstractmethod
    def effects(self) -> tuple[Effect, ...]:
        """Effects whose columns the score needs."""

    @abstractmethod
    def score(self, info: Information) -> float:
        """Return the score of a motion [1]; larger is better.

        Args:
            info: Normal equations of the goal's effects along the motion.
        """


@dataclass(frozen=True, eq=False, repr=False)
class Parameters(Goal):
    """The parameters of effects with the smallest intervals: D-optimality over the combinations that motions can show.

    Attributes:
        wanted: The effects.
        seen: Directions in parameter space that motions can show, as columns, shape (P, r).
    """

    wanted: tuple[Effect, ...]
    seen: Array

    def __repr__(self) -> str:
        return f"Parameters({len(self.wanted)} effects, {self.seen.shape[1]} combinations)"

    @classmethod
    def of(cls, wanted: Sequence[Effect], everything: Information) -> Parameters:
        """Find the combinations of parameters that motions can show.

        Args:
            wanted: The effects.
            everything: Normal equations of many motions over all of the limits.
        """
        at = everything.columns(wanted)
        gram = everything.gram[np.ix_(at, at)]
        scaled = ScaledGram.of(gram)
        unit = np.where(np.diag(gram) <= 0, 0.0, scaled.unit)
        values, vectors = np.linalg.eigh(np.where(np.outer(unit, unit) > 0, scaled.matrix, 0.0))
        shown = values > UNSEEN * max(values[-1], 1e-300)
        return cls(tuple(wanted), unit[:, None] * vectors[:, shown])

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects themselves."""
        return self.wanted

    def score(self, info: Information) -> float:
        """Return the mean logarithm of the inverse standard deviations of what motions can show [1].

        Args:
            info: Normal equations of the effects along the motion.
        """
        at = info.columns(self.wanted)
        gram = self.seen.T @ info.gram[np.ix_(at, at)] @ self.seen
        # a motion that does not show a direction gets a low score, not an infinite one
        values = np.linalg.eigvalsh(gram)
        return float(np.mean(np.log(np.maximum(values, 1e-12)))) / 2


@dataclass(frozen=True, eq=False, repr=False)
class TwoExplanations(Goal):
    """Two explanations, of which a log shows the true one: each in turn is the true one, and the other is fitted to it.

    Attributes:
        one: One explanation.
        two: The other explanation.
        rest: Effects of the model that are fitted as well.
        known: Precision of the prior on their parameters [1/unit²], shape (p,).
        beside: All other parameters, which count once the two explanations are well separated.
        separable: For each explanation, True if some motion shows it when the arm has it.
    """

    one: Side
    two: Side
    rest: tuple[Effect, ...]
    known: Array
    beside: Parameters
    separable: tuple[bool, bool]

    def __repr__(self) -> str:
        return f"TwoExplanations({clipped(self.one.label, 60)} or {clipped(self.two.label, 60)})"

    @classmethod
    def of(
        cls,
        one: Side,
        two: Side,
        rest: Sequence[Effect],
        known: Array,
        beside: Parameters,
        everything: Information,
    ) -> TwoExplanations:
        """Find for each of two explanations whether some motion can show it.

        Args:
            one: One explanation.
            two: The other explanation.
            rest: Effects that are fitted as well.
            known: Precision of the prior on their parameters [1/unit²], shape (p,).
            beside: All other parameters.
            everything: Normal equations of many motions over all of the limits.
        """
        separable = tuple(_differs(everything, a, b, rest) for a, b in ((one, two), (two, one)))
        return cls(one, two, tuple(rest), known, beside, (separable[0], separable[1]))

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Both sides in all their shapes, the rest, and all others."""
        own = (*self.one.all_effects, *self.two.all_effects, *self.rest, *self.beside.effects)
        return tuple(dict.fromkeys(own))

    def distances(self, info: Information) -> tuple[float, float]:
        """Return the misfit of the wrong explanation in standard deviations [1], if one is true and if two is true.

        Args:
            info: Normal equations of both explanations along the motion.
        """
        forth = separation(info, self.one, self.two, self.rest, self.known)
        back = separation(info, self.two, self.one, self.rest, self.known)
        return float(np.sqrt(forth)), float(np.sqrt(back))

    def distance(self, info: Information) -> float:
        """Return the smaller of the distances that a motion can change, in standard deviations [1].

        Args:
            info: Normal equations of both explanations along the motion.
        """
        apart = [d for d, can in zip(self.distances(info), self.separable, strict=True) if can]
        return min(apart, default=0.0)

    def score(self, info: Information) -> float:
        """Return the score of the distance, which saturates once it is large, plus that of all other parameters [1].

        Args:
            info: Normal equations of all effects along the motion.
        """
        square = self.distance(info) ** 2
        return WEIGHT * float(np.log((square + 1e-9) / (square + ENOUGH**2))) + self.beside.score(info)


def _differs(everything: Information, hidden: Side, other: Side, rest: Sequence[Effect]) -> bool:
    """Return True if the other side cannot explain the hidden one on every motion, whatever its parameters."""
    for shape, covariance in zip(hidden.shapes, hidden.covariance, strict=True):
        at = everything.columns(shape)
        whole = float(np.sum(everything.gram[np.ix_(at, at)] * covariance))
        for wrong in other.shapes:
            explainers = [*wrong, *rest]
            free = np.zeros(len(everything.columns(explainers)))
            left = everything.unexplained(shape, explainers, free)
            if float(np.sum(left * covariance)) <= SAME * whole:
                return False
    return True
