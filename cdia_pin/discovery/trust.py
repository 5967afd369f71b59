"""How far each effect of a discovery can be trusted: its decision and its size are repeated under other assumptions.

Nobody knows the right cut-off, the right links, or what else acts. An effect that is real does not depend on them.
The repeats: both halves of the log, 0.7 and 1.4 of the cut-off, and links that are five percent wrong. An established
effect is besides larger than what the model leaves, half of the log shows it by itself, unless every joint has it, and
several blocks of time show it, for one short motion says nothing of the next.
What only joints at rest show is descriptive, because static friction carries an unknown part of their load; it is
likely at most where no joint moves.
An effect that is not everyday must be certain beside all everyday ones, for these are on every arm. A body is asked for
beside the other links too, because the mass of a link is hard to tell from that of the next one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import common_effects
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.changes.sizes import effort_tolerance
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, RotorInertia, Term, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.effects.refinements import is_plain
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.block_evidence import BlockEvidence, BlockFits
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.selection.discovery_settings import ConfidenceSettings, DiscoverySettings
from cdia_pin.selection.problem import Problem

Array = NDArray[np.float64]
Blocks = list[tuple[int, int]]

NO_POWER = 1e-300  # of a torque, squared [1], so that none is not divided by zero
TINY = 1e-150  # least standard deviation, whose square is still above zero


@dataclass(frozen=True)
class Trust:
    """What the repeats say about an effect.

    Attributes:
        confidence: How far its name can be trusted.
        systematic: Half width by which its parameters differ between the repeats, in their units, shape (p,).
    """

    confidence: Confidence
    systematic: Array


def trust_in(logs: Problem, model: Dynamics, given: Dynamics) -> dict[str, Trust]:
    """Return how far the effects that were found can be trusted, by label.

    Args:
        logs: The logs.
        model: The fitted model.
        given: The model before the discovery; its own terms are not judged.
    """
    known = {t.label for t in given.terms}
    found = [t for t in model.terms if t.label not in known]
    if not found:
        return {}
    settings = logs.settings
    whole = Repeat.of(logs, model)
    resting = logs.experiment.resting
    moving = replace(whole, at_rest=False) if resting.any() else whole
    logs.experiment.forget()
    others = [
        Repeat(DesignMatrix(x), replace(model, robot=x.robot), settings).settled() for x in variations(logs)
    ]
    repeats = [*whole.halves, *others]
    out = {}
    for term in found:
        size = whole.theta(term)
        telling = [r for r in repeats if r.survives(term) or r.could_show(term, size)]
        survived = [r.survives(term) for r in telling]
        shown = len(telling) >= settings.confidence.least_shown * len(repeats)
        alone = is_plain(term.effect) or any(half in telling for half in whole.halves)
        if isinstance(term.effect, Body):  # the next link may have the same mass
            survived.append(whole.crowded.survives(term, spared=0))
        moved = [np.abs(r.theta(term) - size) for r in telling]
        torque = whole.torque(term, np.array(term.theta))
        scale = effort_tolerance(logs.experiment, term.effect, torque) * np.abs(term.theta)
        systematic = np.hypot(np.max([np.zeros(term.effect.size), *moved], axis=0), scale)
        lasting = whole.spread(term) >= settings.confidence.least_spread
        moves = moving.needs(term)
        needed = whole.needs(term) and shown and (moves or bool(resting.all()))
        firm = alone and lasting and whole.stands_out(term) and moves
        confidence = _confidence(needed, firm, survived, settings.confidence)
        out[term.label] = Trust(confidence, systematic)
    return out


def is_everyday(effect: Effect) -> bool:
    """Tell whether every arm has an effect: friction of a joint, a rotor, another mass, an offset.

    Args:
        effect: The effect.
    """
    plain = isinstance(effect, Body | RotorInertia | TorqueOffset)
    return plain or is_friction_of_joint(effect)


def _confidence(
    needed: bool, firm: bool, survived: Sequence[bool], settings: ConfidenceSettings
) -> Confidence:
    if not needed or np.mean(survived) < settings.likely_share:
        return Confidence.DESCRIPTIVE
    return Confidence.ESTABLISHED if firm and all(survived) else Confidence.LIKELY


def variations(logs: Problem) -> Iterator[Experiment]:
    """Yield the logs with other cut-offs and with wrong links, which nobody knows better.

    Args:
        logs: The logs.
    """
    x, settings = logs.experiment, logs.settings
    for factor in settings.confidence.cutoffs:
        try:
            yield Experiment.of(x.robot, list(_filtered(logs, factor)), x.rest)
        except LogError:  # the log cannot be filtered there: its rate is too low, or too little is left
            continue
    bodies = x.robot.inertial_parameters
    for seed in range(settings.confidence.wrong_links):
        error = np.random.default_rng(seed).normal(0.0, settings.confidence.link_error, len(bodies))
        robot = x.robot.with_inertial_parameters(bodies * (1 + error[:, None]))
        yield Experiment.of(robot, [s.motion for s in x.segments], x.rest)


def _filtered(logs: Problem, factor: float) -> Iterator[Motion]:
    for log, segment in zip(logs.logs, logs.experiment.segments, strict=True):
        given = replace(logs.settings.searched, cutoff=factor * segment.motion.cutoff)
        yield condition(log, logs.experiment.robot, given)


@dataclass(frozen=True, repr=False)
class Repeat:
    """The decision about the effects of a model under one set of assumptions.

    Attributes:
        design: The logs, and columns of effects.
        model: The fitted model.
        settings: What an effect must show.
        everyday: Whether all everyday effects are fitted beside the model's, each with a prior.
        part: Half of the blocks of time that is used, 0 or 1; all blocks if None.
        at_rest: Whether the torque of joints that are near rest for most of every log counts.
    """

    design: DesignMatrix
    model: Dynamics
    settings: DiscoverySettings
    everyday: bool = False
    part: int | None = None
    at_rest: bool = True

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
        """The same fit on each half of the log alone."""
        return replace(self, part=0), replace(self, part=1)

    @cached_property
    def crowded(self) -> Self:
        """The same fit beside all everyday effects."""
        return replace(self, everyday=True)

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
        return bool(helps and fits.certainty[one] >= self.settings.confidence.least_certainty)

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
        power = np.array([shown[start:stop].sum() for start, stop in self._blocks()])
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
        spread = np.maximum(np.sqrt(np.diag(self.covariance(term))), TINY)
        relative = self.covariance(term) / np.outer(spread, spread) + 1e-9 * np.eye(len(spread))
        scaled = np.asarray(theta) / spread
        expected = np.sqrt(scaled @ np.linalg.solve(relative, scaled) / len(scaled))
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
        return float(self._beside(one).certainty[one])

    def is_visible(self, term: Term) -> bool:
        """Tell whether an effect is sure, of some size, and explains a visible share of what is left.

        Args:
            term: A term of the model.
        """
        x, one, rule = self.experiment, self._at[term.label], self.settings.changes
        fits, use = self._beside(one), self._used
        gain, torque = float(fits.gain[one]), self.torque(term, fits.theta[one])
        measured = np.maximum(rms(x.measured, use), 1e-12)
        return rule.is_sure(fits.certainty[one], gain) and rule.is_visible(
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

    def covariance(self, term: Term) -> Array:
        """Return the covariance of the parameters of an effect, shape (p, p).

        Args:
            term: A term of the model.
        """
        own = self._evidence.parameters[self._at[term.label]]
        return self._estimate[1][own, own]

    @cached_property
    def _at(self) -> dict[str, int]:
        return {e.label: i for i, e in enumerate(self._evidence.effects)}

    @cached_property
    def _estimate(self) -> tuple[Array, Array]:
        return self._evidence.estimate(range(len(self._evidence.effects)))

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
        return BlockEvidence.of(effects, regression, self._blocks(), robot)

    def _blocks(self) -> Blocks:
        """Return first and last sample of each block of time."""
        edges = np.linspace(0, len(self.experiment.measured), self.settings.confidence.blocks + 1).astype(int)
        every = list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
        middle = len(every) // 2
        return every if self.part is None else (every[:middle] if self.part == 0 else every[middle:])
