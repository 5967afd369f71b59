"""Alternatives: other explanations that the logs hardly distinguish from the one that was found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from cdia_pin.effects import Effect, Varying
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import motion_between
from cdia_pin.identifiability.structural_rank import are_alike, contains, generic_rank, torque_elsewhere
from cdia_pin.regression.gauss_newton import is_exact
from cdia_pin.selection.discovery_settings import AlternativeSettings
from cdia_pin.selection.evidence import Evidence, SetFit
from cdia_pin.selection.replacement import Refit, promising


@dataclass(frozen=True)
class _Alternative:
    """A candidate, and by how much its cost exceeds the limit; negative for a possible alternative."""

    worse: float
    index: int


@dataclass(frozen=True)
class Alternatives:
    """What else could explain what the effects of a fitted model do.

    Attributes:
        evidence: Evidence for the model's effects and all candidates around it.
        chosen: Indices of the model's effects.
        refit: Fits alternatives that are not linear. If None, they are taken to first order, which is enough for a
            ranking.
        settings: When another explanation counts as possible.
    """

    evidence: Evidence
    chosen: Sequence[int]
    refit: Refit | None = None
    settings: AlternativeSettings = field(default_factory=AlternativeSettings)

    def of(self, one: int) -> tuple[Confusion, ...]:
        """Return what explains as much in the place of one effect, or of it and another on its joint.

        An alternative is judged by the residual that it leaves, not by its penalty: a less simple one is less likely,
        not impossible. An alternative that contains the effect on every motion is only another name for it if the
        log determines its other parameters.

        Args:
            one: Index of one of the model's effects.
        """
        evidence = self.evidence
        found = evidence.fit(self.chosen, bodies=True)
        alternatives: dict[str, _Alternative] = {}
        for replaced in ([one], *([one, c] for c in self._neighbours(one))):
            rest = [c for c in self.chosen if c not in replaced]
            for other in self._promising(rest, found):
                label = evidence.effects[other].label
                worse = self._cost(rest, other, found, replaced) - self._limit(found, replaced)
                if worse < min(0.0, alternatives[label].worse if label in alternatives else 0.0):
                    alternatives[label] = _Alternative(worse, other)
        best = sorted(alternatives.values(), key=lambda a: self._rank(one, a))
        effects = [evidence.effects[a.index] for a in best]
        known = [evidence.effects[one], *effects]
        plain = [e for e in effects if not (isinstance(e, Varying) and e.effect in known)]
        return tuple(Confusion((e,), motion_between(evidence.effects[one], e, evidence.robot)) for e in plain)

    def _rank(self, one: int, alternative: _Alternative) -> tuple[bool, bool, float]:
        """Return the sort key: first alternatives that some motion rules out, then simple ones, then close ones."""
        evidence, other = self.evidence, alternative.index
        same = are_alike(evidence.robot, evidence.effects[one], evidence.effects[other])
        return same, self._is_richer(one, other), alternative.worse

    def _is_richer(self, one: int, other: int) -> bool:
        count = self.evidence.effective_parameters
        return bool(count[other] > count[one])

    def _limit(self, found: SetFit, replaced: Sequence[int]) -> float:
        """Return the largest cost of an alternative. One effect for two must be simpler, so its penalty counts."""
        return (found.chi2 if len(replaced) == 1 else found.cost) + self._doubt(found)

    def _doubt(self, found: SetFit) -> float:
        """Return the difference up to which explanations are hard to distinguish; structure that is left raises it."""
        return self.settings.doubt * max(1.0, found.chi2 / max(self.evidence.samples, 1))

    def _promising(self, rest: Sequence[int], found: SetFit) -> Iterator[int]:
        """Yield candidates that, added to the rest, explain nearly as much as what they replace."""
        lost = self.evidence.free_chi2(rest) - found.chi2
        names = {self.evidence.effects[c].label for c in found.chosen}

        def enough(effect: Effect) -> float:
            share = 1.0 if self.refit is None or is_exact(effect) else self.settings.first_order_share
            return share * lost - self._doubt(found)

        found_again = promising(self.evidence, rest, enough)
        yield from (c for c, _ in found_again if self.evidence.effects[c].label not in names)

    def _cost(self, rest: Sequence[int], other: int, found: SetFit, replaced: Sequence[int]) -> float:
        """Return what an alternative leaves; one effect for two also pays for the parameters that it needs."""
        evidence, effect = self.evidence, self.evidence.effects[other]
        if len(replaced) == 1 and self._is_other_name(found, replaced[0], rest, other):
            return float("inf")
        if self.refit is not None and not is_exact(effect):
            fit = self.refit(rest, other)
        else:
            fit = evidence.fit([*rest, other], bodies=True)
        if len(replaced) == 1:  # what the log does not determine may be anything
            return fit.chi2 if fit.possible else float("inf")
        if not fit.physical:
            return float("inf")
        needed = evidence.identifiable_parameters(evidence.fit([*rest, other]), other)
        unneeded = max(float(evidence.effective_parameters[other]) - needed, 0.0)
        return fit.cost - evidence.penalty_per_parameter * unneeded

    def _is_other_name(self, found: SetFit, one: int, rest: Sequence[int], other: int) -> bool:
        """Return True if an alternative contains the effect and its other parameters matter little elsewhere."""
        robot, mine, effect = self.evidence.robot, self.evidence.effects[one], self.evidence.effects[other]
        if generic_rank(robot, effect) <= generic_rank(robot, mine) or not contains(robot, effect, mine):
            return False
        theta = found.theta[self.evidence.equations.own(found.chosen, one)]
        explained = torque_elsewhere(robot, mine, np.outer(theta, theta))
        undetermined = torque_elsewhere(
            robot, effect, self.evidence.equations.covariance([*rest, other], other)
        )
        return bool(np.all(undetermined <= self.settings.undetermined_share * np.max(explained)))

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
