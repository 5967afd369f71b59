"""Confusions: other explanations that this motion tells poorly from the one that was found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from cdia_pin.discovery.evidence import Evidence, Fit
from cdia_pin.discovery.fitting import Whitened, gather, refit
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.result import Confusion
from cdia_pin.discovery.spans import are_alike, contains, generic_rank, rank_of_gram
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.robot.model import RobotModel

DOUBT = 30.0  # variances of the noise by which two explanations may differ and be hard to tell apart
NEARLY = (
    0.9  # share of what was explained that a rival must explain to be fitted as it is, not to first order
)


Refit = Callable[[Sequence[int], int], Fit]  # indices of a set and of one more, fitted at their own optimum


@dataclass(frozen=True)
class Rivals:
    """Who else could explain what the effects of a fitted model do.

    Attributes:
        evidence: Normal equations of the model's effects and all candidates around it.
        chosen: Indices of the model's effects.
        refit: Fits rivals that are not linear; if None they are taken to first order, which is enough for a ranking.
    """

    evidence: Evidence
    chosen: Sequence[int]
    refit: Refit | None = None

    def of(self, one: int) -> tuple[Confusion, ...]:
        """Return what explains as much in the place of one effect, or of it and another on its joint.

        A rival is measured by what it leaves, not by its price: that it is less simple makes it less likely, not
        impossible. One that can do all that the effect can, on any motion, is another name for it if the log
        determines its parameters.

        Args:
            one: Index of one of the model's effects.
        """
        evidence = self.evidence
        found = evidence.fit(self.chosen, bodies=True)
        rivals: dict[str, tuple[float, Effect]] = {}
        for replaced in ([one], *([one, c] for c in self._neighbours(one))):
            rest = [c for c in self.chosen if c not in replaced]
            for other in self._promising(rest, found):
                effect = evidence.effects[other]
                worse = self._cost(rest, other, found, replaced) - self._limit(found, replaced)
                if worse < min(0.0, rivals.get(effect.label, (0.0,))[0]):
                    rivals[effect.label] = (worse, effect)
        best = [e for _, e in sorted(rivals.values(), key=lambda r: r[0])]
        return tuple(Confusion((e,), motion_between(evidence.effects[one], e, evidence.robot)) for e in best)

    def _limit(self, found: Fit, replaced: Sequence[int]) -> float:
        """Return the largest cost of a rival; of one for two, which must be simpler, its price counts."""
        # structure that is left makes all less sure
        left = max(1.0, found.chi2 / max(self.evidence.samples, 1))
        return (found.chi2 if len(replaced) == 1 else found.cost) + DOUBT * left

    def _promising(self, rest: Sequence[int], found: Fit) -> Iterator[int]:
        """Yield the candidates that explain beside the others nearly what was explained, of each the best shape."""
        evidence = self.evidence
        gains, lost = evidence.gains(rest), evidence.free_chi2(rest) - found.chi2
        spare = self._limit(found, [0]) - found.chi2
        taken = {evidence.effects[c].label for c in found.chosen}
        for c in gains.argsort()[::-1]:
            effect = evidence.effects[c]
            share = 1.0 if self.refit is None or _is_exact(effect) else NEARLY
            enough = share * lost - spare
            if gains[c] >= enough and effect.label not in taken:
                taken.add(effect.label)
                yield int(c)

    def _cost(self, rest: Sequence[int], other: int, found: Fit, replaced: Sequence[int]) -> float:
        """Return what a rival leaves; of one for two with the price of those parameters that it needs."""
        evidence, effect = self.evidence, self.evidence.effects[other]
        if len(replaced) == 1 and self._is_other_name(evidence.effects[replaced[0]], other):
            return float("inf")
        if self.refit is not None and not _is_exact(effect):
            fit = self.refit(rest, other)
        else:
            fit = evidence.fit([*rest, other], bodies=True)
        if not fit.physical:
            return float("inf")
        if len(replaced) == 1:
            return fit.chi2
        idle = max(
            evidence.freedom[other] - evidence.told_from_zero(evidence.fit([*rest, other]), other), 0.0
        )
        return fit.cost - evidence.price_per_parameter * idle

    def _is_other_name(self, mine: Effect, other: int) -> bool:
        """Tell whether a rival is the effect itself with more parameters, all of which the log determines."""
        robot, effect, span = self.evidence.robot, self.evidence.effects[other], self.evidence.spans[other]
        directions = generic_rank(robot, effect)
        wider = directions > generic_rank(robot, mine) and contains(robot, effect, mine)
        return wider and rank_of_gram(self.evidence.total[span][:, span]) >= directions

    def _neighbours(self, one: int) -> list[int]:
        """Return the other found effects that act on just the same joint."""
        evidence = self.evidence
        joints = evidence.effects[one].acts_on(evidence.robot)
        alone = len(joints) == 1
        return [
            c
            for c in self.chosen
            if alone and c != one and evidence.effects[c].acts_on(evidence.robot) == joints
        ]


def _is_exact(effect: Effect) -> bool:
    return effect.linear and not effect.of_torque


def refitting(problem: Problem, model: Dynamics, whitened: Whitened, evidence: Evidence) -> Refit:
    """Return how a rival is fitted in the place of effects of a model, as exactly as the model itself."""

    def refitted(rest: Sequence[int], other: int) -> Fit:
        kept, effect = {evidence.effects[c] for c in rest}, evidence.effects[other]
        terms = tuple(t for t in model.terms if t.effect in kept)
        trial = Dynamics(model.robot, (*terms, Term(effect, (0.0,) * effect.size)))
        experiment, columns = problem.experiment, problem.columns
        trial, _ = refit(experiment, columns, trial, whitened)
        effects = [t.effect for t in trial.terms]
        beside = gather(experiment, columns, experiment.predict(trial), effects, whitened)
        return beside.fit(range(len(effects)), bodies=True)

    return refitted


MOTIONS = {
    "sign": "move the joint both ways at several constant speeds, slow and fast",
    "speed": "move the joint at several constant speeds up to its fastest",
    "acceleration": "reverse quickly at small amplitude, then move at constant speed",
    "gravity": "hold the arm in poses with gravity on and off the joint, at rest and moving slowly",
    "position": "sweep the joint slowly over its whole range, both ways",
    "wrist": "turn the wrist through all orientations, at two reaches of the arm",
}
NEEDS = {
    "coulomb_friction": "sign",
    "asymmetric_friction": "sign",
    "stribeck_friction": "speed",
    "viscous_friction": "speed",
    "quadratic_friction": "speed",
    "coupled_friction": "speed",
    "viscous_medium": "speed",
    "rotor_inertia": "acceleration",
    "effort_delay": "acceleration",
    "load_friction": "gravity",
    "actuator_gain": "gravity",
    "torque_offset": "gravity",
    "base_tilt": "gravity",
    "encoder_offset": "gravity",
    "joint_spring": "position",
    "position_ripple": "position",
    "payload": "wrist",
    "tool_wrench": "wrist",
    "link_inertia": "wrist",
}


def motion_between(one: Effect, other: Effect, robot: RobotModel) -> str:
    """Return in words a motion in which two effects differ."""
    if are_alike(robot, one, other):
        return (
            "no motion of this arm does: take off what may be the cause, such as the tool, and record again"
        )
    needs = dict.fromkeys(NEEDS.get(e.name, "position") for e in (one, other))
    return "; ".join(MOTIONS[n] for n in needs)
