"""A question that a motion answers: its goal, and the gain of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics, Trajectory
from cdia_pin.effects import CoulombFriction, Effect, LinkInertia, Unknown, ViscousFriction
from cdia_pin.errors import EffectError
from cdia_pin.excitation.excitation_result import Gain
from cdia_pin.excitation.excitation_settings import ExcitationSettings
from cdia_pin.excitation.goals import Goal, Parameters, TwoExplanations
from cdia_pin.excitation.information import Information, planned, torque_rms
from cdia_pin.excitation.limits import MotionLimits
from cdia_pin.excitation.motion import Draw, within_room
from cdia_pin.excitation.sides import Side, side_of
from cdia_pin.identifiability.distinguishing_motions import weightless_remark, why_alike
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.log import Log
from cdia_pin.regression.experiment import Experiment

Array = NDArray[np.float64]

THOUGHT = 6  # motions over all of the limits [1], never driven, that stand for any motion
Explanation = Effect | Sequence[Effect]


@dataclass(frozen=True, repr=False)
class Question:
    """A question about one arm within its limits.

    Attributes:
        model: The model of the arm as it is known.
        limits: Limits of motions.
        settings: Duration, sizes, noise.
    """

    model: Dynamics
    limits: MotionLimits
    settings: ExcitationSettings

    def __repr__(self) -> str:
        return f"Question({self.model!r}, {self.settings.duration:g} s)"

    @cached_property
    def everything(self) -> Experiment:
        """Motions over all of the limits; contacts are not checked."""
        rng = np.random.default_rng(0)
        draws = (Draw.random(self._anywhere(rng), rng) for _ in range(THOUGHT))
        motions = [d.trajectory(self.settings.duration, self.limits) for d in draws]
        return planned(self.model.robot, *motions)

    @cached_property
    def noise(self) -> Array:
        """Standard deviation of a torque sample [N·m or N], shape (n,)."""
        return self.settings.noise * torque_rms(self.everything, self.model)

    def information(self, experiment: Experiment, effects: Sequence[Effect]) -> Information:
        """Return the normal equations of effects along a motion.

        Args:
            experiment: The motion.
            effects: The effects.
        """
        return Information.along(experiment, self.model, effects, self.noise)

    def parameters(self, wanted: Sequence[Effect] | None = None) -> Parameters:
        """Return the goal of a motion that shows the parameters of effects.

        Args:
            wanted: The effects; the model's own if omitted, or friction and inertia if it has none.
        """
        robot = self.model.robot
        chosen = tuple(dict.fromkeys(wanted or [t.effect for t in self.model.terms] or self._common()))
        for effect in chosen:
            effect.check(robot)
        return Parameters.of(chosen, self.information(self.everything, chosen))

    def between(self, one: Explanation, two: Explanation) -> TwoExplanations:
        """Return the goal of a motion that shows which of two explanations is true.

        Args:
            one: One effect, or several together.
            two: The other explanation.

        Raises:
            EffectError: If they are the same, one has no torque or no equation, or no motion separates them.
        """
        first, second = (_listed(x) for x in (one, two))
        labels = [sorted(e.label for e in x) for x in (first, second)]
        if labels[0] == labels[1]:
            raise EffectError(f"{' + '.join(labels[0])} was given twice: name two different explanations")
        for effect in (*first, *second):
            effect.check(self.model.robot)
            if isinstance(effect, Unknown):
                raise EffectError(f"{effect.label} has no equation: name an effect with one")
        sides = [side_of(x, self.model, self.everything, self.settings.size) for x in (first, second)]
        named = {label for side in labels for label in side}
        rest = tuple(t.effect for t in self.model.terms if t.label not in named)
        one_side, other = sides
        asked = (*one_side.all_effects, *other.all_effects, *rest)
        info = self.information(self.everything, tuple(dict.fromkeys(asked)))
        for side in sides:
            if not _has_torque(side, info):
                remark = weightless_remark(side.effects, self.model.robot)
                raise EffectError(f"{side.label} has no torque on any motion of this arm{remark}")
        known = np.concatenate([np.zeros(0), *(1.0 / e.prior_scale(self.model.robot) ** 2 for e in rest)])
        goal = TwoExplanations.of(one_side, other, rest, known, self.parameters(self._common()), info)
        if not any(goal.separable):
            why = why_alike(one_side.effects, other.effects, self.model.robot)
            raise EffectError(f"no motion of this arm tells {one_side.label} from {other.label}: {why}")
        return goal

    def gain(self, goal: Goal, motion: Trajectory, other: Trajectory, logs: Sequence[Log] = ()) -> Gain:
        """Return the gain of a motion over logs that exist, or over another motion.

        Args:
            goal: The goal.
            motion: The designed motion.
            other: The other motion, used if there are no logs.
            logs: Logs that exist.
        """
        robot = self.model.robot
        there_is = (
            Experiment.of(robot, [condition(x, robot) for x in logs]) if logs else planned(robot, other)
        )
        old, new = (self.information(x, goal.effects) for x in (there_is, planned(robot, motion)))
        beside = "on the logs given" if logs else "on some motion within the limits"
        if isinstance(goal, TwoExplanations):
            names = (goal.one.label, goal.two.label)
            return Gain(names, goal.distance(old), goal.distance(new), (0, 0), goal.separable, beside)
        assert isinstance(goal, Parameters)
        sharper = float(np.exp(goal.score(new) - goal.score(old)))
        return Gain((), 1.0, sharper, (goal.seen.shape[1], goal.seen.shape[0]), (), beside)

    def _common(self) -> list[Effect]:
        """Return friction and inertia of all joints, which a motion should always show."""
        kinds: tuple[type[Effect], ...] = (CoulombFriction, ViscousFriction, LinkInertia)
        return [kind.from_scope((joint,), {}) for kind in kinds for joint in self.model.robot.joints]

    def _anywhere(self, rng: np.random.Generator) -> Array:
        return within_room(rng.uniform(self.limits.lower, self.limits.upper), self.limits)


def _has_torque(side: Side, everything: Information) -> bool:
    """Tell whether an explanation gives any torque on any motion."""
    at = everything.columns(side.shapes[0])
    return bool(everything.gram[np.ix_(at, at)].any())


def _listed(effects: Explanation) -> tuple[Effect, ...]:
    return (effects,) if isinstance(effects, Effect) else tuple(effects)
