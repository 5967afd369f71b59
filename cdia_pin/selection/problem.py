"""The problem of a discovery: logs, candidates and settings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.log import Log
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.lack_of_fit import LackOfFit, lack_of_fit
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.time_blocks import Block, time_blocks
from cdia_pin.regression.whitening import Whitening
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.candidates import drifting, enumerate_candidates, per_log, screen
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.evidence import Evidence, needed_gain

Array = NDArray[np.float64]

GENERIC_SIZE = 10  # parameters [1]; effects with as many or more would fit noise in its first estimate
GENERIC_SHAPES = 20  # shapes [1]; effects with as many or more would fit noise too


@dataclass(frozen=True, repr=False)
class Problem:
    """Logs, candidates and settings of a discovery.

    Attributes:
        experiment: The conditioned logs.
        held_out: Conditioned logs that are only predicted, if any.
        design: Columns of effects, kept for reuse.
        families: Candidates in families: each is one effect and scope in its shapes.
        settings: The settings.
        differing: Labels of effects that may have parameters per log, because they changed between the logs.
        logs: The logs as they were measured, to be filtered in other ways too.
    """

    experiment: Experiment
    held_out: Experiment | None
    design: DesignMatrix
    families: tuple[list[Effect], ...]
    settings: DiscoverySettings
    differing: tuple[str, ...] = ()
    logs: tuple[Log, ...] = ()

    def __repr__(self) -> str:
        return f"Problem({self.experiment!r}, {len(self.families)} candidates)"

    @classmethod
    def of(
        cls, model: Dynamics, logs: Sequence[Log], holdout: Sequence[Log], settings: DiscoverySettings
    ) -> Problem:
        """Condition the logs and enumerate the candidates.

        Args:
            model: The model of the arm as it is known.
            logs: Logs to fit.
            holdout: Logs that are only predicted.
            settings: Effects that may be found, and how logs are conditioned.

        Raises:
            LogError: If a log is too short or of other joints.
            EffectError: If the settings name an effect that is not in the vocabulary.
        """
        return cls.conditioned(model.robot, logs, holdout, settings).around(model)

    @classmethod
    def conditioned(
        cls, robot: RobotModel, logs: Sequence[Log], holdout: Sequence[Log], settings: DiscoverySettings
    ) -> Problem:
        """Condition the logs, without candidates; `around` adds them.

        Args:
            robot: The arm.
            logs: Logs to fit.
            holdout: Logs that are only predicted.
            settings: How logs are conditioned.
        """
        motions, unseen = (
            [condition(log, robot, settings.searched) for log in part] for part in (logs, holdout)
        )
        experiment = Experiment.of(robot, motions, settings.rest)
        held_out = Experiment.of(robot, unseen, settings.rest) if unseen else None
        return cls(experiment, held_out, DesignMatrix(experiment), (), settings, logs=tuple(logs))

    def around(self, model: Dynamics) -> Problem:
        """Return the same logs with the candidates for a model; the columns are shared.

        Args:
            model: The present model.
        """
        experiment = self.experiment
        families = enumerate_candidates(experiment, experiment.predict(model), self.settings)
        return replace(self, families=tuple(families))

    def without(self, labels: Iterable[str]) -> Problem:
        """Return the problem without some candidates.

        Args:
            labels: Labels of the effects.
        """
        gone = set(labels)
        return replace(self, families=tuple(f for f in self.families if f[0].label not in gone))

    def with_drift(self, model: Dynamics) -> Problem:
        """Return the problem in which the model's own friction and offsets may drift too.

        Args:
            model: The present model.
        """
        known = {f[0].label for f in self.families}
        more = drifting([t.effect for t in model.terms], self.experiment)
        return replace(self, families=(*self.families, *(f for f in more if f[0].label not in known)))

    def with_parts(self, labels: Iterable[str]) -> Problem:
        """Return the problem in which some effects may have parameters per log or common ones.

        Args:
            labels: Labels of the effects.
        """
        labels = tuple(labels)
        apart = [per_log(f, self.experiment, labels) for f in self.families if f[0].label in labels]
        return replace(self, families=(*self.families, *apart), differing=labels)

    def without_rest_of(self, effects: Iterable[Effect]) -> Problem:
        """Return the problem without the samples at which friction between two joints may stick.

        Args:
            effects: Effects of a model.
        """
        known = list(effects)
        experiment = self.experiment.without_rest_of(known)
        if experiment is self.experiment:
            return self
        held_out = self.held_out and self.held_out.without_rest_of(known)
        return replace(self, experiment=experiment, held_out=held_out, design=DesignMatrix(experiment))

    # ------------------------------------------------------------- noise

    def with_first_noise(self, model: Dynamics) -> WhitenedProblem:
        """Return the problem with the noise before a search: the residual that all simple, common effects leave.

        Args:
            model: The model as it is known.
        """
        common = [f for f in self.families if f[0].plausibility.is_common]
        generic = [f[0] for f in common if f[0].size < GENERIC_SIZE and len(f) < GENERIC_SHAPES]
        effects = list(dict.fromkeys([*(t.effect for t in model.terms), *generic]))
        left = self._lack_of_fit(self.experiment.predict(model), effects)
        return WhitenedProblem(self, Whitening.of(self.experiment, left.innermost, self.blocks))

    def with_noise_of(self, left: LackOfFit) -> WhitenedProblem:
        """Return the problem with the noise that follows from the lack of fit of a model.

        Args:
            left: Lack of fit of the model.
        """
        return WhitenedProblem(self, Whitening.of(self.experiment, left.noise, self.blocks))

    def lack_of_fit(self, model: Dynamics) -> LackOfFit:
        """Look for structure in the residual of a fitted model.

        Args:
            model: The model at its optimum.
        """
        return self._lack_of_fit(self.experiment.predict(model), [t.effect for t in model.terms])

    # ------------------------------------------------------------- sizes

    @cached_property
    def smallest_torque(self) -> Array:
        """Least RMS torque of an effect that matters and that the sensors resolve [N·m or N], shape (n,)."""
        measured = rms(self.experiment.measured, self.experiment.informative)
        return np.maximum(self.experiment.resolution, self.settings.criterion.least_torque * measured)

    def rms(self, model: Dynamics) -> Array:
        """Return the RMS residual of a model.

        Args:
            model: The model.

        Returns:
            In N·m or N, shape (n,).
        """
        return rms(self.experiment.predict(model).residual, self.experiment.informative)

    @cached_property
    def blocks(self) -> list[Block]:
        """Samples of each block of time."""
        return time_blocks(self.experiment.segments, self.settings.blocks)

    @property
    def edges(self) -> NDArray[np.intp]:
        """First compared sample of each contiguous block, and the end, shape (B + 1,).

        What is left in each repeat of a motion is structure, so that repeats are not kept together here.
        """
        return np.linspace(0, len(self.experiment.measured), self.settings.blocks + 1).astype(int)

    def _lack_of_fit(self, prediction: Prediction, effects: Sequence[Effect]) -> LackOfFit:
        """Look for structure that effects leave, as if each joint had its own parameters of them."""
        present = {e: np.array(t.theta) for e, t in prediction.present.items()}
        own: list[list[Array]] = [
            [np.zeros((len(prediction.residual), 0))] for _ in self.experiment.robot.joints
        ]
        for effect in effects:
            x = self.design.of(effect, prediction, present.get(effect))
            for i, j in enumerate(effect.acts_on(self.experiment.robot)):
                own[j].append(x[:, i, :])
        columns = [np.column_stack(parts) for parts in own]
        given = self.settings
        return lack_of_fit(self.experiment, prediction, columns, self.edges, given.lack_of_fit, given.noise)


@dataclass(frozen=True, repr=False)
class WhitenedProblem:
    """A problem whose noise is known.

    Attributes:
        problem: Logs, candidates and settings.
        whitening: Noise of each joint, samples that count, and blocks of time.
    """

    problem: Problem
    whitening: Whitening

    def __repr__(self) -> str:
        return f"WhitenedProblem({self.problem!r})"

    @cached_property
    def regression(self) -> Regression:
        """The logs with columns and noise."""
        return Regression(self.problem.design, self.whitening)

    @property
    def experiment(self) -> Experiment:
        """The conditioned logs."""
        return self.problem.experiment

    @property
    def settings(self) -> DiscoverySettings:
        """The settings."""
        return self.problem.settings

    def without(self, labels: Iterable[str]) -> WhitenedProblem:
        """Return the problem without some candidates.

        Args:
            labels: Labels of the effects.
        """
        return replace(self, problem=self.problem.without(labels))

    def with_drift(self, model: Dynamics) -> WhitenedProblem:
        """Return the problem in which the model's own friction and offsets may drift too.

        Args:
            model: The present model.
        """
        return replace(self, problem=self.problem.with_drift(model))

    def with_noise_left_by(self, model: Dynamics) -> WhitenedProblem:
        """Return the problem with the noise that a fitted model leaves where its friction cannot stick.

        Args:
            model: The model at its optimum.
        """
        problem = self.problem.without_rest_of(t.effect for t in model.terms)
        return problem.with_noise_of(problem.lack_of_fit(model))

    def evidence(self, model: Dynamics, *, candidates: bool = True) -> Evidence:
        """Return the evidence for a model's effects and all candidates.

        Args:
            model: The present model.
            candidates: Whether sets with other effects are wanted. Without them the evidence for the model's own
                effects is the same, and takes a fraction of the time.
        """
        prediction = self.experiment.predict(model)
        leftover = self.whitening.every(prediction.residual)
        families = self.problem.families
        screened = (
            screen(families, self.problem.design, prediction, self.whitening.noise, leftover)
            if candidates
            else ()
        )
        present = [t.effect for t in model.terms]
        effects = list(dict.fromkeys([*present, *screened]))
        return Evidence(
            self.regression.normal_equations(prediction, effects),
            self.settings.criterion,
            searched={e.label: 1 for e in present} | {f[0].label: len(f) for f in families},
            needed=needed_gain(
                np.sum(leftover**2, axis=0),
                rms(prediction.residual, self.experiment.informative),
                self.problem.smallest_torque,
                self.settings.criterion.least_share,
            ),
        )
