"""The decision about the effects of a model under one set of assumptions: what is certain, visible and beyond doubt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import common_effects
from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, RotorInertia, Term, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.regression.block_evidence import BlockEvidence, BlockFits, certainty_of
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.regression.speed_parts import speed_parts
from cdia_pin.regression.time_blocks import Block, in_half, time_blocks, within
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem

Array = NDArray[np.float64]

NO_POWER = 1e-300  # of a torque, squared [1], so that none is not divided by zero


def is_everyday(effect: Effect) -> bool:
    """Tell whether every arm has an effect: friction of a joint, a rotor, another mass, an offset.

    Args:
        effect: The effect.
    """
    plain = isinstance(effect, Body | RotorInertia | TorqueOffset)
    return plain or is_friction_of_joint(effect)


@dataclass(frozen=True, repr=False)
class Repeat:
    """The decision about the effects of a model under one set of assumptions.

    Attributes:
        design: The logs, and columns of effects.
        model: The fitted model.
        settings: What an effect must show.
        everyday: Whether all everyday effects are fitted beside the model's, each with a prior.
        part: Half of every log that is used, 0 or 1; all of them if None.
        at_rest: Whether the torque of joints that are near rest for most of every log counts.
        by_speed: Whether parameters are fitted without each quarter of the speeds too, to tell how uncertain they are.
            What is certain is decided by blocks of time.
    """

    design: DesignMatrix
    model: Dynamics
    settings: DiscoverySettings
    everyday: bool = False
    part: int | None = None
    at_rest: bool = True
    by_speed: bool = False

    def __repr__(self) -> str:
        return f"Repeat({self.experiment!r})"

    @classmethod
    def of(cls, logs: Problem, model: Dynamics) -> Self:
        """Return the decision on logs as they are.

        Args:
            logs: The logs and settings.
            model: A fitted model.
        """
        return cls(logs.design, model, logs.settings)

    @property
    def experiment(self) -> Experiment:
        """The logs."""
        return self.design.experiment

    @cached_property
    def halves(self) -> tuple[Self, Self]:
        """The same fit on each half of every log alone."""
        return replace(self, part=0, by_speed=False), replace(self, part=1, by_speed=False)

    @cached_property
    def crowded(self) -> Self:
        """The same fit beside all everyday effects."""
        return replace(self, everyday=True, by_speed=False)

    def settled(self) -> Self:
        """Return the repeat with its normal equations, and without the regressors that they were computed from."""
        _ = self._evidence, self._size
        self.experiment.forget()
        return self

    def survives(self, term: Term, spared: int = 1) -> bool:
        """Tell whether an effect is certain, and helps on blocks of time that its fit did not see.

        Args:
            term: A term of the model.
            spared: Number of blocks on which it may fail: a motion of one block alone is not predicted from others.
        """
        one = self._at[term.label]
        fits = self._beside(one)
        helps = np.sort(fits.gains[one])[spared:].sum() > 0
        return bool(helps and fits.certainty_by_time[one] >= self.settings.confidence.least_certainty)

    def stands_out(self, term: Term) -> bool:
        """Tell whether the torque of an effect is larger on some joint than what the model leaves there.

        Args:
            term: A term of the model.
        """
        own = self.torque(term, np.array(term.theta))
        return bool(np.any(own >= self.settings.confidence.least_over_left * self._size))

    def spread(self, term: Term) -> float:
        """Return over which share of the blocks of time the squared torque of an effect is spread [1].

        It is the square of the sum over the sum of the squares of what the blocks show, over their number: one if each
        shows as much, and one block's share if a single block shows all of it.

        Args:
            term: A term of the model.
        """
        torque = self._columns[term.label].torque(np.array(term.theta), self.experiment.robot.n)
        shown = ((np.where(self._used, torque, 0.0) / self._size) ** 2).sum(axis=1)
        power = np.array([shown[block].sum() for block in self._blocks])
        return float(power.sum() ** 2 / (len(power) * max(power @ power, NO_POWER)))

    def could_show(self, term: Term, theta: Array) -> bool:
        """Tell whether an effect of some size would be certain here. A joint that hardly moves shows nothing.

        Args:
            term: A term of the model.
            theta: Its size in the whole log, shape (p,).
        """
        own = self._evidence.parameters[self._at[term.label]]
        power = (
            self._evidence.norms[own] * np.asarray(theta) ** 2
        )  # of its torque, over that of what is left [1]
        if power.sum() < 1.0:
            return False
        unit = np.sqrt(self._evidence.norms[own])
        covariance = self.covariance(term) * np.outer(unit, unit)
        (expected,) = certainty_of((np.asarray(theta) * unit)[None], covariance[None])
        return bool(expected >= self.settings.confidence.power * self.settings.confidence.least_certainty)

    def needs(self, term: Term) -> bool:
        """Tell whether an effect is visible, beside all everyday effects too unless it is one or a body.

        Args:
            term: A term of the model.
        """
        visible = self.is_visible(term)
        if not visible or is_everyday(term.effect):
            return visible
        crowded = self.crowded
        if crowded.is_clear(term):
            return crowded.survives(term)
        return crowded.is_visible(term) and crowded.is_beyond_doubt(term)

    def is_beyond_doubt(self, term: Term) -> bool:
        """Tell whether an effect is as certain as its kind needs, an unusual one far more than others, or is clear.

        Args:
            term: A term of the model.
        """
        usual = not self.settings.is_unusual(term.effect)
        least = self.settings.confidence.unusual_certainty
        return usual or self.certainty(term) >= least or self.is_clear(term)

    def is_clear(self, term: Term) -> bool:
        """Tell whether all others leave far more torque of its joints on blocks of time that were not fitted.

        Args:
            term: A term of the model.
        """
        one, joints = self._at[term.label], list(term.effect.acts_on(self.experiment.robot))
        left = float(self._used[:, joints].sum())  # in units of what the model leaves
        return float(self._beside(one).gain[one]) >= (self.settings.confidence.clear_of_others**2 - 1) * left

    def certainty(self, term: Term) -> float:
        """Return the estimate of an effect over its standard deviation [1], root mean square over the parameters.

        Args:
            term: A term of the model.
        """
        one = self._at[term.label]
        return float(self._beside(one).certainty_by_time[one])

    def is_visible(self, term: Term) -> bool:
        """Tell whether an effect is sure, of some size, and explains a visible share of what is left.

        Args:
            term: A term of the model.
        """
        x, one, rule = self.experiment, self._at[term.label], self.settings.changes
        fits, use = self._beside(one), self._used
        gain, torque = float(fits.gain[one]), self.torque(term, fits.theta[one])
        measured = np.maximum(rms(x.measured, use), 1e-12)
        return rule.is_sure(fits.certainty_by_time[one], gain) and rule.is_visible(
            gain, torque, self._size, measured, use.sum(axis=0)
        )

    def torque(self, term: Term, theta: Array) -> Array:
        """Return the RMS torque of an effect [N·m or N], shape (n,).

        Args:
            term: A term of the model.
            theta: Values of its parameters, shape (p,).
        """
        return rms(self._columns[term.label].torque(theta, self.experiment.robot.n), self._used)

    def _beside(self, one: int) -> BlockFits:
        """Return the fits beside all terms but one."""
        return self._evidence.fits([c for c in range(len(self._evidence.effects)) if c != one])

    def theta(self, term: Term) -> Array:
        """Return the parameters of an effect, fitted together with all others, shape (p,).

        Args:
            term: A term of the model.
        """
        own = self._evidence.parameters[self._at[term.label]]
        return self._estimate[0][own]

    def theta_without(self, term: Term, left_out: Sequence[Term]) -> Array:
        """Return the parameters of an effect, fitted together with all others but some, shape (p,).

        Args:
            term: A term of the model.
            left_out: Terms that are left out.
        """
        kept = [i for label, i in self._at.items() if label not in {t.label for t in left_out}]
        parts = ParameterBlocks.of([self._evidence.effects[i] for i in kept])
        return self._evidence.estimate(kept)[0][parts[kept.index(self._at[term.label])]]

    def covariance(self, term: Term) -> Array:
        """Return the covariance of the parameters of an effect from blocks of time, shape (p, p).

        Args:
            term: A term of the model.
        """
        own = self._evidence.parameters[self._at[term.label]]
        return self._estimate[1][0, own, own]

    def covariance_by_speed(self, term: Term) -> Array:
        """Return the covariance that also holds what quarters of the speeds show, where they are asked, shape (p, p).

        Args:
            term: A term of the model.
        """
        own = self._evidence.parameters[self._at[term.label]]
        return self._estimate[1][1, own, own]

    @cached_property
    def _at(self) -> dict[str, int]:
        return {e.label: i for i, e in enumerate(self._evidence.effects)}

    @cached_property
    def _estimate(self) -> tuple[Array, Array]:
        return self._evidence.estimate_with_both(range(len(self._evidence.effects)))

    @cached_property
    def _used(self) -> NDArray[np.bool_]:
        """True for the samples that count, shape (K, n)."""
        x = self.experiment
        return x.informative & (self.at_rest | ~x.resting)

    @cached_property
    def _prediction(self) -> Prediction:
        return self.experiment.predict(self.model)

    @cached_property
    def _size(self) -> Array:
        """RMS torque of each joint that the model leaves [N·m or N], shape (n,)."""
        return np.maximum(rms(self._prediction.residual, self.experiment.informative), 1e-12)

    @cached_property
    def _columns(self) -> dict[str, ColumnGroup]:
        """Columns of each term, without a prior."""
        robot, terms = self.experiment.robot, self.model.terms
        columns = (self.design.of(t.effect, self._prediction, np.array(t.theta)) for t in terms)
        return {t.label: ColumnGroup.of(t.effect, x, robot) for t, x in zip(terms, columns, strict=True)}

    @cached_property
    def _evidence(self) -> BlockEvidence[Effect]:
        x, robot, prediction = self.experiment, self.experiment.robot, self._prediction
        effects = [t.effect for t in self.model.terms]
        own = [self._columns[t.label] for t in self.model.terms]
        torques = (g.torque(np.array(t.theta), robot.n) for g, t in zip(own, self.model.terms, strict=True))
        response = sum(torques, prediction.residual)
        common: list[ColumnGroup] = []
        if self.everyday:
            carried = {e.carrier(robot) for e in effects if isinstance(e, Body)}

            def beside(e: Effect) -> bool:
                same = isinstance(e, Body) and e.carrier(robot) in carried  # another name of the same body
                return is_everyday(e) and e not in effects and not same

            common = common_effects(x, prediction, self.design, beside)
        regression = SharedRegression.of(
            [*common, *own],
            response,
            lambda j, part: np.where(self._used[:, [j]], part / self._size[j], 0.0),
        )
        parts = speed_parts(x, self._used) if self.by_speed else ()
        return BlockEvidence.of(effects, regression, self._blocks, robot, parts)

    @cached_property
    def _blocks(self) -> list[Block]:
        """Samples of each block of time."""
        segments = self.experiment.segments
        every = time_blocks(segments, self.settings.confidence.blocks)
        return every if self.part is None else within(every, in_half(segments, self.part))
