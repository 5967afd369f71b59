"""The fit of one log: by how much each effect of a robot differs from its model in this log.

The model stays as it is. All effects of its joints, what every joint has besides, and what changes with the job are
fitted together, as differences. Bodies and other effects of the whole arm do not wear: they may move within their own
intervals, so that their uncertainty reaches the intervals of the others. Effects that the model lacks are then looked
for, each alone beside this fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.fleet.fleet_effects import FleetEffects, Role
from cdia_pin.fleet.fleet_settings import FleetFitSettings
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.block_evidence import BlockEvidence
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.intervals import NORMAL_95
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.regression.time_blocks import time_blocks
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

ROUNDS = 2  # rounds of weighting [1], because weights and residuals depend on each other
NEGLIGIBLE = (
    1e-6  # torque of one unit of a parameter over the joint's [1], below which rounding decides its value
)


@dataclass(frozen=True, repr=False)
class LogFit:
    """One log beside the model of its robot.

    Attributes:
        experiment: The conditioned log.
        prediction: Prediction of the model.
        effects: The effects that can be seen in this log.
        settings: How it is fitted.
        every: All effects of the robot with their roles.
        hidden: Why the log does not show an effect.
    """

    experiment: Experiment
    prediction: Prediction
    effects: FleetEffects
    settings: FleetFitSettings
    every: tuple[tuple[Effect, Role], ...]
    hidden: dict[Effect, str]

    def __repr__(self) -> str:
        return f"LogFit({self.experiment!r}, {len(self.effects.fitted)} effects)"

    @classmethod
    def of(cls, experiment: Experiment, model: Dynamics, settings: FleetFitSettings) -> Self:
        """Prepare the fit.

        Args:
            experiment: The conditioned log.
            model: The model of its robot.
            settings: What is fitted.
        """
        prediction = experiment.predict(model)
        given = FleetEffects.of(model, settings)
        hidden = dict(given.hidden_in(experiment, prediction, settings.least_moving))
        effects = replace(
            given,
            fitted={e: role for e, role in given.fitted.items() if e not in hidden},
            searched=tuple(e for e in given.searched if e not in hidden),
        )
        every = given.fitted | dict.fromkeys(given.searched, Role.SEARCHED)
        return cls(experiment, prediction, effects, settings, tuple(every.items()), hidden)

    @property
    def robot(self) -> RobotModel:
        """The arm."""
        return self.experiment.robot

    @property
    def motion(self) -> Motion:
        """The conditioned log."""
        return self.experiment.segments[0].motion

    @property
    def quantile(self) -> float:
        """Half width of a 95 % interval over the standard deviation from the blocks [1]."""
        from scipy.special import stdtrit

        return float(stdtrit(self.settings.blocks - 1, 0.975))

    def why_not_shown(self, effect: Effect) -> str:
        """Return why this log says nothing about an effect; empty if it does.

        Args:
            effect: Any effect of the robot.
        """
        if effect in self.hidden:
            return self.hidden[effect]
        unit = self.torque(effect, np.ones(effect.size))
        return "" if (unit > NEGLIGIBLE * self._measured).any() else "the motion does not depend on it"

    def difference(self, effect: Effect) -> tuple[Array, Array]:
        """Return by how much the parameters of an effect differ from the model, shape (p,), and their covariance.

        Args:
            effect: One that is fitted, or looked for.
        """
        if effect in self._at_fitted:
            own = self._blocks[self._at_fitted[effect]]
            theta, covariance = self._together
        else:
            k = self._count + self.effects.searched.index(effect)
            theta, covariance = self._evidence.estimate([*range(self._count), k])
            own = slice(len(theta) - effect.size, len(theta))
        return theta[own], covariance[own, own]

    def torque(self, effect: Effect, theta: Array) -> Array:
        """Return the RMS torque of some parameters of an effect [N·m or N], shape (n,).

        Args:
            effect: One that is fitted, or looked for.
            theta: The parameters, shape (p,).
        """
        return rms(self._columns[effect].torque(theta, self.robot.n), self.experiment.informative)

    def is_drowned(self, effect: Effect, half_widths: Array) -> bool:
        """Tell whether an effect of the size of its interval would be as large as all torque of a joint.

        Args:
            effect: One that is fitted, or looked for.
            half_widths: Of its parameters' intervals, shape (p,).
        """
        return bool((self.torque(effect, half_widths) > self._measured).any())

    def is_named(self, effect: Effect) -> bool:
        """Tell whether this log alone would name an effect beside the fit, by the rule of `compare`.

        Args:
            effect: One that is looked for.
        """
        rule, use = self.settings.discovery.changes, self.experiment.informative
        k = self._count + self.effects.searched.index(effect)
        fits = self._evidence.fits(range(self._count))
        gain, torque = float(fits.gain[k]), self.torque(effect, fits.theta[k])
        return rule.is_sure(fits.certainty[k], gain) and rule.is_visible(
            gain, torque, self.error, self._measured, use.sum(axis=0)
        )

    @cached_property
    def _measured(self) -> Array:
        """RMS measured torque of each joint, above zero [N·m or N], shape (n,)."""
        return np.maximum(rms(self.experiment.measured, self.experiment.informative), 1e-12)

    @cached_property
    def error(self) -> Array:
        """RMS torque of each joint that the fit leaves [N·m or N], shape (n,)."""
        return self._weights

    @cached_property
    def given_error(self) -> Array:
        """RMS torque of each joint that the model leaves [N·m or N], shape (n,)."""
        return rms(self.prediction.residual, self.experiment.informative)

    @cached_property
    def load(self) -> Array:
        """RMS torque of each joint in the model with what this job adds to it [N·m or N], shape (n,)."""
        torque = self.prediction.torques[0].actuator[self.motion.kept]
        for effect, role in self.effects.fitted.items():
            if role is Role.JOB:
                on_arm = self._columns[effect].torque(self.difference(effect)[0], self.robot.n)
                torque = torque - on_arm  # the motor carries what acts on the arm
        return np.asarray(np.sqrt(np.mean(torque**2, axis=0)))

    @cached_property
    def _columns(self) -> dict[Effect, ColumnGroup]:
        fitted = {e: ColumnGroup.of(e, self._columns_of(e), self.robot) for e in self.effects.fitted}
        return fitted | self._searched_columns(fitted)

    def _columns_of(self, effect: Effect) -> Array:
        term = self.effects.of_model.get(effect.label)
        return self.experiment.columns(
            effect, self.prediction, None if term is None else np.array(term.theta)
        )

    def _searched_columns(self, fitted: dict[Effect, ColumnGroup]) -> dict[Effect, ColumnGroup]:
        """Return the columns of what is looked for, along the fitted torque: a gain scales friction and payload too."""
        groups = [*self._held, *fitted.values()]
        first, use = len(groups) - len(fitted), self.experiment.informative
        theta = SharedRegression.of(
            groups, self.prediction.residual, lambda j, x: np.where(use[:, [j]], x / self._given_size[j], 0.0)
        ).theta()
        parts = ParameterBlocks(tuple(len(g.scale) for g in groups)).split(theta)[first:]
        model = self.prediction.model
        there = [t for t in model.terms if t.effect not in fitted]
        refitted = [Term(e, tuple(self.effects.in_model(e) + d)) for e, d in zip(fitted, parts, strict=True)]
        along = self.experiment.predict(replace(model, terms=(*there, *refitted)))
        return {
            e: ColumnGroup.of(e, self.experiment.columns(e, along), self.robot) for e in self.effects.searched
        }

    @property
    def _given_size(self) -> Array:
        """RMS torque of each joint that the model leaves, above zero [N·m or N], shape (n,)."""
        return np.maximum(self.given_error, 1e-12)

    @cached_property
    def _held(self) -> list[ColumnGroup]:
        """Columns of what may move within its interval only; what has no interval stays as it is."""
        out = []
        for term in self.effects.held:
            scale = term.half_widths / NORMAL_95
            if (scale > 0).any():
                columns = self._columns_of(term.effect) * (scale > 0)
                out.append(
                    ColumnGroup.of(term.effect, columns, self.robot, np.where(scale > 0, scale, np.inf))
                )
        return out

    @cached_property
    def _weights(self) -> Array:
        """RMS torque of each joint that the fit leaves, by which its rows are weighted [N·m or N], shape (n,)."""
        use = self.experiment.informative
        size = self._given_size
        for _ in range(ROUNDS):
            left, _ = self._regression(tuple(self.effects.fitted), size).residual()
            size = np.maximum(rms(left, use) * size, 1e-12)
        return size

    def _regression(self, effects: Sequence[Effect], size: Array) -> SharedRegression:
        use = self.experiment.informative
        return SharedRegression.of(
            [*self._held, *(self._columns[e] for e in effects)],
            self.prediction.residual,
            lambda j, x: np.where(use[:, [j]], x / size[j], 0.0),
        )

    @cached_property
    def _evidence(self) -> BlockEvidence[Effect]:
        every = (*self.effects.fitted, *self.effects.searched)
        blocks = time_blocks(self.experiment.segments, self.settings.blocks)
        return BlockEvidence.of(every, self._regression(every, self._weights), blocks, self.robot)

    @cached_property
    def _together(self) -> tuple[Array, Array]:
        return self._evidence.estimate(range(self._count))

    @cached_property
    def _blocks(self) -> ParameterBlocks:
        return ParameterBlocks.of(self.effects.fitted)

    @cached_property
    def _at_fitted(self) -> dict[Effect, int]:
        return {e: k for k, e in enumerate(self.effects.fitted)}

    @property
    def _count(self) -> int:
        return len(self.effects.fitted)
