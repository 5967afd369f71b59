"""The problem of a discovery: logs, candidates and settings, and what follows from them for any model."""

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
from cdia_pin.regression.design_matrix import Columns
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.fitting import Whitened, gather
from cdia_pin.regression.lack_of_fit import Structure, look_for_structure
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.candidates import drifting, enumerate_candidates, per_log, screen
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.evidence import Evidence, needed_gain

Array = NDArray[np.float64]

SMALLEST_TORQUE = 0.01  # of a joint's RMS torque: an effect below that changes nothing a user would notice
GENERIC_SIZE = 10  # larger effects do not take part in the first estimate of the noise
GENERIC_SHAPES = 20  # nor do those with more shapes


@dataclass(frozen=True)
class Problem:
    """What a discovery works on.

    Attributes:
        experiment: The conditioned logs.
        held_out: Conditioned logs that are only predicted, if any.
        columns: Columns of effects, kept for reuse.
        families: Candidates, each effect and scope with its shapes.
        settings: The settings.
        differing: Labels of effects that may have parameters of their own in each log, since something changed.
    """

    experiment: Experiment
    held_out: Experiment | None
    columns: Columns
    families: tuple[list[Effect], ...]
    settings: DiscoverySettings
    differing: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, model: Dynamics, logs: Sequence[Log], holdout: Sequence[Log], settings: DiscoverySettings
    ) -> Problem:
        """Condition the logs and enumerate the candidates."""
        return cls.conditioned(model.robot, logs, holdout, settings).around(model)

    @classmethod
    def conditioned(
        cls, robot: RobotModel, logs: Sequence[Log], holdout: Sequence[Log], settings: DiscoverySettings
    ) -> Problem:
        """Condition the logs, without candidates: `around` a model there are."""
        motions, unseen = (
            [condition(log, robot, settings.conditioning) for log in part] for part in (logs, holdout)
        )
        experiment = Experiment.of(robot, motions)
        held_out = Experiment.of(robot, unseen) if unseen else None
        return cls(experiment, held_out, Columns(experiment), (), settings)

    def around(self, model: Dynamics) -> Problem:
        """Return the same logs with the candidates around a model; several questions share their columns."""
        experiment = self.experiment
        families = enumerate_candidates(experiment, experiment.predict(model), self.settings)
        return replace(self, families=tuple(families))

    @property
    def edges(self) -> NDArray[np.intp]:
        """First compared sample of each block of time, and the end, shape (B + 1,)."""
        return np.linspace(0, len(self.experiment.measured), self.settings.blocks + 1).astype(int)

    def with_drift(self, model: Dynamics) -> Problem:
        """Return the problem in which the model's own friction and offsets may drift as well."""
        known = {f[0].label for f in self.families}
        more = drifting([t.effect for t in model.terms], self.experiment)
        return replace(self, families=(*self.families, *(f for f in more if f[0].label not in known)))

    def with_parts(self, labels: Iterable[str]) -> Problem:
        """Return the problem in which some effects may have parameters of their own in each log, or common ones."""
        labels = tuple(labels)
        apart = [per_log(f, self.experiment, labels) for f in self.families if f[0].label in labels]
        return replace(self, families=(*self.families, *apart), differing=labels)

    def without_rest_of(self, effects: Iterable[Effect]) -> Problem:
        """Return the problem without the samples at which what some effects rub may stick."""
        known = list(effects)
        experiment = self.experiment.without_rest_of(known)
        if experiment is self.experiment:
            return self
        held_out = self.held_out and self.held_out.without_rest_of(known)
        return replace(self, experiment=experiment, held_out=held_out, columns=Columns(experiment))

    def first_noise(self, model: Dynamics) -> Whitened:
        """Estimate the noise before anything is known: what all simple effects together leave."""
        generic = [f[0] for f in self.families if f[0].size < GENERIC_SIZE and len(f) < GENERIC_SHAPES]
        effects = list(dict.fromkeys([*(t.effect for t in model.terms), *generic]))
        return self.whitened(self._structure(self.experiment.predict(model), effects), innermost=True)

    def whitened(self, structure: Structure, *, innermost: bool = False) -> Whitened:
        """Return what whitens residuals whose structure is known."""
        noise = structure.innermost if innermost else structure.noise
        return Whitened.of(self.experiment, noise, self.edges)

    @cached_property
    def smallest_torque(self) -> Array:
        """RMS torque of an effect that matters and is above what the sensors resolve [N·m or N], shape (n,)."""
        measured = rms(self.experiment.measured, self.experiment.informative)
        return np.maximum(self.experiment.resolution, SMALLEST_TORQUE * measured)

    def rms(self, model: Dynamics) -> Array:
        """Return the RMS residual of a model [N·m or N], shape (n,)."""
        return rms(self.experiment.predict(model).residual, self.experiment.informative)

    def structure(self, model: Dynamics) -> Structure:
        """Look for structure in what a fitted model leaves."""
        return self._structure(self.experiment.predict(model), [t.effect for t in model.terms])

    def beside(self, prediction: Prediction, whitened: Whitened) -> Evidence:
        """Form the normal equations of a model's effects and all candidates around it."""
        joints = range(self.experiment.robot.n)
        leftover = np.column_stack([whitened.joint(j, prediction.residual[:, j]) for j in joints])
        screened = screen(self.families, self.columns, prediction, whitened.noise, leftover)
        present = [t.effect for t in prediction.model.terms]
        effects = list(dict.fromkeys([*present, *screened]))
        evidence = gather(self.experiment, self.columns, prediction, effects, whitened)
        use = self.experiment.informative
        return replace(
            evidence,
            searched={e.label: 1 for e in present} | {f[0].label: len(f) for f in self.families},
            needed=needed_gain(
                np.sum(leftover**2, axis=0),
                rms(prediction.residual, use),
                self.smallest_torque,
            ),
        )

    def _structure(self, prediction: Prediction, effects: Sequence[Effect]) -> Structure:
        """Look for structure beside effects, as if each joint had its own parameters of them."""
        present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
        own: list[list[Array]] = [
            [np.zeros((len(prediction.residual), 0))] for _ in self.experiment.robot.joints
        ]
        for effect in effects:
            x = self.columns.of(effect, prediction, present.get(effect))
            for i, j in enumerate(effect.acts_on(self.experiment.robot)):
                own[j].append(x[:, i, :])
        return look_for_structure(
            self.experiment, prediction, [np.column_stack(parts) for parts in own], self.edges
        )
