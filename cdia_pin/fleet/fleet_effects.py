"""The effects of a robot, by what is done with them in each log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import EFFECTS, Effect, Term, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.effects.refinements import PLAIN_FRICTION
from cdia_pin.fleet.fleet_settings import FleetFitSettings
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.selection.candidates import enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]


class Role(StrEnum):
    """What an effect is in the fit of a log."""

    MODEL = "model"
    USUAL = "usual"
    JOB = "job"
    SEARCHED = "searched"


@dataclass(frozen=True)
class FleetEffects:
    """The effects of one robot, by what is done with them in each log.

    Attributes:
        fitted: Effects that are fitted together, with their roles.
        searched: Effects that are looked for, each alone beside these.
        held: Terms of the model that may move within their intervals.
        of_model: The terms of the model by label.
    """

    fitted: dict[Effect, Role]
    searched: tuple[Effect, ...]
    held: tuple[Term, ...]
    of_model: dict[str, Term]

    @classmethod
    def of(cls, model: Dynamics, settings: FleetFitSettings) -> Self:
        """Sort the effects of a robot.

        Args:
            model: Its model.
            settings: What changes with the job, and what is looked for.
        """
        robot = model.robot
        wearing = [t.effect for t in model.terms if t.effect.scope and not isinstance(t.effect, Body)]
        rubbing = {e.scope[0] for e in wearing if is_friction_of_joint(e)}
        plain = [kind(j) for kind in PLAIN_FRICTION for j in robot.joints if j not in rubbing]
        job = [EFFECTS[name].from_scope(s, {}) for name in settings.job for s in EFFECTS[name].scopes(robot)]
        usual: list[Effect] = [*plain, *(TorqueOffset(j) for j in robot.joints)]
        of_model = {t.label: t for t in model.terms}
        roles: dict[Role, Sequence[Effect]] = {
            Role.USUAL: usual,
            Role.MODEL: wearing,
            Role.JOB: job,
        }  # the last one that holds counts
        fitted = {e.label: role for role, effects in roles.items() for e in effects}
        named = {e.label: e for effects in roles.values() for e in effects} | {
            label: t.effect for label, t in of_model.items()
        }
        others = (EFFECTS[name].from_scope((j,), {}) for name in settings.searched for j in robot.joints)
        return cls(
            {named[label]: role for label, role in fitted.items()},
            tuple(e for e in others if e.label not in fitted),
            tuple(t for t in model.terms if t.label not in fitted),
            of_model,
        )

    def in_model(self, effect: Effect) -> Array:
        """Return the parameters of an effect in the model, zero where the model lacks it, shape (p,).

        Args:
            effect: Any effect of the robot.
        """
        term = self.of_model.get(effect.label)
        return np.zeros(effect.size) if term is None else np.array(term.theta)

    def hidden_in(
        self, experiment: Experiment, prediction: Prediction, least_moving: float
    ) -> Iterator[tuple[Effect, str]]:
        """Yield the effects that a motion does not show, and why: a joint rests, or carries no load.

        Args:
            experiment: The conditioned log.
            prediction: Prediction of the model.
            least_moving: Share of the time in which a joint must move [1].
        """
        every = (*self.fitted, *self.searched)
        names = tuple(dict.fromkeys(e.name for e in every if e.name in EFFECTS))
        settings = DiscoverySettings(effects=names)
        shown = {f[0].label for f in enumerate_candidates(experiment, prediction, settings)}
        moving = experiment.robot.by_joint(experiment.moving.mean(axis=0))
        for e in every:
            resting = [j for j in e.scope if moving[j] < least_moving]
            if resting:
                seen, needed = (f"{100 * x:.0f} %" for x in (moving[resting[0]], least_moving))
                yield e, f"{resting[0]} moves in {seen} of the log, {needed} are needed"
            elif e.label not in shown and e.label not in self.of_model:
                yield e, "the motion does not show it"
