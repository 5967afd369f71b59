"""Confusions: other explanations that this motion tells poorly from the one that was found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cdia_pin.effects import Effect, Varying
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import motion_between
from cdia_pin.identifiability.structural_rank import are_alike, contains, generic_rank, torque_elsewhere
from cdia_pin.regression.fitting import is_exact
from cdia_pin.selection.evidence import Evidence, Fit
from cdia_pin.selection.refits import NEARLY, Refit, promising

DOUBT = 30.0  # variances of the noise by which two explanations may differ and be hard to tell apart
UNSURE = (
    0.2  # of the torque explained: what a rival may do elsewhere, by one standard deviation, to be determined
)


@dataclass(frozen=True)
class _Rival:
    """How much worse a candidate is than what may be in doubt, and its index."""

    worse: float
    index: int


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
        impossible. One that can do all that the effect can, on any motion, is only another name for it if the log
        determines the rest of it.

        Args:
            one: Index of one of the model's effects.
        """
        evidence = self.evidence
        found = evidence.fit(self.chosen, bodies=True)
        rivals: dict[str, _Rival] = {}
        for replaced in ([one], *([one, c] for c in self._neighbours(one))):
            rest = [c for c in self.chosen if c not in replaced]
            for other in self._promising(rest, found):
                label = evidence.effects[other].label
                worse = self._cost(rest, other, found, replaced) - self._limit(found, replaced)
                if worse < min(0.0, rivals[label].worse if label in rivals else 0.0):
                    rivals[label] = _Rival(worse, other)
        best = sorted(rivals.values(), key=lambda r: self._rank(one, r))
        effects = [evidence.effects[r.index] for r in best]
        known = [evidence.effects[one], *effects]
        plain = [e for e in effects if not (isinstance(e, Varying) and e.effect in known)]
        return tuple(Confusion((e,), motion_between(evidence.effects[one], e, evidence.robot)) for e in plain)

    def _rank(self, one: int, rival: _Rival) -> tuple[bool, bool, float]:
        """Return by what rivals are sorted: first those that some motion tells, then the simple, then the close."""
        evidence, other = self.evidence, rival.index
        same = are_alike(evidence.robot, evidence.effects[one], evidence.effects[other])
        return same, bool(evidence.freedom[other] > evidence.freedom[one]), rival.worse

    def _limit(self, found: Fit, replaced: Sequence[int]) -> float:
        """Return the largest cost of a rival; of one for two, which must be simpler, its price counts."""
        return (found.chi2 if len(replaced) == 1 else found.cost) + self._doubt(found)

    def _doubt(self, found: Fit) -> float:
        """Return by how much explanations may differ and be hard to tell apart: structure that is left adds to it."""
        return DOUBT * max(1.0, found.chi2 / max(self.evidence.samples, 1))

    def _promising(self, rest: Sequence[int], found: Fit) -> Iterator[int]:
        """Yield the candidates that explain beside the others nearly what was explained."""
        lost = self.evidence.free_chi2(rest) - found.chi2
        names = {self.evidence.effects[c].label for c in found.chosen}

        def enough(effect: Effect) -> float:
            share = 1.0 if self.refit is None or is_exact(effect) else NEARLY
            return share * lost - self._doubt(found)

        found_again = promising(self.evidence, rest, enough)
        yield from (c for c, _ in found_again if self.evidence.effects[c].label not in names)

    def _cost(self, rest: Sequence[int], other: int, found: Fit, replaced: Sequence[int]) -> float:
        """Return what a rival leaves; of one for two with the price of those parameters that it needs."""
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
        idle = max(
            evidence.freedom[other] - evidence.told_from_zero(evidence.fit([*rest, other]), other), 0.0
        )
        return fit.cost - evidence.price_per_parameter * idle

    def _is_other_name(self, found: Fit, one: int, rest: Sequence[int], other: int) -> bool:
        """Tell whether a rival is an effect itself with more parameters, which could not do much else elsewhere."""
        robot, mine, effect = self.evidence.robot, self.evidence.effects[one], self.evidence.effects[other]
        if generic_rank(robot, effect) <= generic_rank(robot, mine) or not contains(robot, effect, mine):
            return False
        theta = found.theta[np.isin(self.evidence.columns(found.chosen), self.evidence.spans[one])]
        explained = torque_elsewhere(robot, mine, np.outer(theta, theta))
        undetermined = torque_elsewhere(robot, effect, self.evidence.covariance([*rest, other], other))
        return bool(np.all(undetermined <= UNSURE * np.max(explained)))

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
