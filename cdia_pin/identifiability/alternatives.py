"""Alternatives: other explanations that the logs hardly distinguish from the one that was found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from cdia_pin.effects import Effect, Varying
from cdia_pin.effects.effect import share_a_joint
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import motion_between
from cdia_pin.identifiability.structural_rank import are_alike, contains, generic_rank, torque_elsewhere
from cdia_pin.regression.gauss_newton import is_exact
from cdia_pin.selection.discovery_settings import AlternativeSettings
from cdia_pin.selection.evidence import Evidence, SetFit
from cdia_pin.selection.replacement import Refit, promising

# Alternatives that are named per effect. At one speed and in one direction four kinds of friction and an offset are
# the same torque: with two, the right name was among them in 59 % of such logs.
MOST = 4  # [1]
# Candidates per effect [1] on its joint, and as many elsewhere, that are fitted at their own optimum, the best first.
MOST_REFITS = 2
FEW_REFITS = 1  # the same [1] for an effect that may be anything


@dataclass(frozen=True)
class _Candidate:
    """An effect that may explain as much in the place of others.

    Attributes:
        index: Index of the effect.
        replaced: Indices of what it replaces: one effect, or that and another on its joint.
        left: Residual sum of squares to first order, in variances of the noise [1].
    """

    index: int
    replaced: tuple[int, ...]
    left: float


@dataclass(frozen=True)
class Alternatives:
    """What else could explain what the effects of a fitted model do.

    Attributes:
        evidence: Evidence for the model's effects and all candidates around it.
        chosen: Indices of the model's effects.
        refit: Fits alternatives that are not linear. If None, they are taken to first order, which is enough for a
            ranking.
        settings: When another explanation counts as possible.
        most_refits: Candidates per effect on its joint, and as many elsewhere, that are fitted so [1].
    """

    evidence: Evidence
    chosen: Sequence[int]
    refit: Refit | None = None
    settings: AlternativeSettings = field(default_factory=AlternativeSettings)
    most_refits: int = MOST_REFITS

    def of(self, one: int) -> tuple[Confusion, ...]:
        """Return what explains as much in the place of one effect, or of it and another on its joint.

        An alternative is judged by the residual that it leaves, not by its penalty: a less simple one is less likely,
        not impossible. An alternative that contains the effect on every motion is only another name for it if the
        log determines its other parameters.

        At most four are named: those of the same joint first, and of these the ones that some motion rules out.

        Args:
            one: Index of one of the model's effects.
        """
        robot, mine = self.evidence.robot, self.evidence.effects[one]
        named: list[Effect] = []
        for same in (True, False):
            separable: list[Effect] = []
            alike: list[Effect] = []
            for other in self._possible(one, same, named):
                (alike if are_alike(robot, mine, other) else separable).append(other)
                if len(separable) == MOST:
                    break
            named += [*separable, *alike]
            if len(named) >= MOST:
                break
        return tuple(Confusion((e,), motion_between(mine, e, robot)) for e in named[:MOST])

    def _possible(self, one: int, same: bool, named: Sequence[Effect]) -> Iterator[Effect]:
        """Yield the effects of the same joint, or others that share one, that explain as much, each in one shape."""
        evidence = self.evidence
        found = evidence.fit(self.chosen, bodies=True)
        known = [evidence.effects[one], *named]
        candidates = [
            c
            for c in self._candidates(one, found)
            if self._is_same_joint(one, c.index) is same and self._share_a_joint(one, c.index)
        ]
        refits = 0
        for candidate in sorted(candidates, key=lambda c: self._rank(one, c)):
            effect = evidence.effects[candidate.index]
            repeated = isinstance(effect, Varying) and effect.effect in known
            if (
                repeated
                or effect.label in [e.label for e in known[1:]]
                or self._is_other_name(found, candidate)
            ):
                continue
            needs_refit = self.refit is not None and not is_exact(effect)
            refits += needs_refit
            if needs_refit and refits > self.most_refits:
                continue
            if self._cost(candidate) < self._limit(found, candidate.replaced):
                known.append(effect)
                yield effect

    def _candidates(self, one: int, found: SetFit) -> Iterator[_Candidate]:
        """Yield candidates that, added to the rest, explain nearly as much as what they replace."""
        names = {self.evidence.labels[c] for c in found.chosen}
        for replaced in ((one,), *((one, c) for c in self._neighbours(one))):
            rest = [c for c in self.chosen if c not in replaced]
            left = self.evidence.free_chi2(rest)

            def enough(effect: Effect, lost: float = left - found.chi2) -> float:
                share = 1.0 if self.refit is None or is_exact(effect) else self.settings.first_order_share
                return share * lost - self._doubt(found)

            for other, gain in promising(self.evidence, rest, enough):
                if self.evidence.labels[other] not in names:
                    yield _Candidate(other, replaced, left - gain)

    def _is_same_joint(self, one: int, other: int) -> bool:
        """Return True if two effects name the same joints, or act on the same."""
        robot, mine, effect = self.evidence.robot, self.evidence.effects[one], self.evidence.effects[other]
        return effect.scope == mine.scope or effect.acts_on(robot) == mine.acts_on(robot)

    def _share_a_joint(self, one: int, other: int) -> bool:
        """Return True if two effects act on a common joint; else they have no torque in common.

        What an effect of another joint explains there, where the model fits badly, says nothing of this one.
        """
        robot, effects = self.evidence.robot, self.evidence.effects
        return share_a_joint(effects[one], effects[other], robot)

    def _rank(self, one: int, candidate: _Candidate) -> tuple[bool, float]:
        """Return the sort key: first simple alternatives, then close ones."""
        count = self.evidence.effective_parameters
        return bool(count[candidate.index] > count[one]), candidate.left

    def _limit(self, found: SetFit, replaced: Sequence[int]) -> float:
        """Return the largest cost of an alternative. One effect for two must be simpler, so its penalty counts."""
        return (found.chi2 if len(replaced) == 1 else found.cost) + self._doubt(found)

    def _doubt(self, found: SetFit) -> float:
        """Return the difference up to which explanations are hard to distinguish; structure that is left raises it."""
        return self.settings.doubt * max(1.0, found.chi2 / max(self.evidence.samples, 1))

    def _cost(self, candidate: _Candidate) -> float:
        """Return what an alternative leaves; one effect for two also pays for the parameters that it needs."""
        evidence, other = self.evidence, candidate.index
        rest = [c for c in self.chosen if c not in candidate.replaced]
        if self.refit is not None and not is_exact(evidence.effects[other]):
            fit = self.refit(rest, other)
        else:
            fit = evidence.fit([*rest, other], bodies=True)
        if len(candidate.replaced) == 1:  # what the log does not determine may be anything
            return fit.chi2 if fit.possible else float("inf")
        if not fit.physical:
            return float("inf")
        needed = evidence.identifiable_parameters(evidence.fit([*rest, other]), other)
        unneeded = max(float(evidence.effective_parameters[other]) - needed, 0.0)
        return fit.cost - evidence.penalty_per_parameter * unneeded

    def _is_other_name(self, found: SetFit, candidate: _Candidate) -> bool:
        """Return True if an alternative contains the effect and its other parameters matter little elsewhere."""
        if len(candidate.replaced) > 1:
            return False
        (one,), other = candidate.replaced, candidate.index
        robot, mine, effect = self.evidence.robot, self.evidence.effects[one], self.evidence.effects[other]
        if generic_rank(robot, effect) <= generic_rank(robot, mine) or not contains(robot, effect, mine):
            return False
        theta = found.theta[self.evidence.equations.own(found.chosen, one)]
        explained = torque_elsewhere(robot, mine, np.outer(theta, theta))
        rest = [c for c in self.chosen if c != one]
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
