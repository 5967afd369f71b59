"""Where in the motion the effects of one joint are present: as the bank has it, or as it was seen."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank, on_joint
from cdia_pin.diagnosis.belief import Belief
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.region import RegionLearner
from cdia_pin.effects import Profile, Region, Term

Array = NDArray[np.float64]

VISIBLE = 1.5  # [1], torque of an effect over the threshold, above which a look at it is a sighting


class Presence:
    """Profiles of the effects of a joint.

    Args:
        joint: Its name.
        bank: The effects.

    Attributes:
        profiles: Of the effects that are corrected for only where they are present, by index.
    """

    def __init__(self, joint: str, bank: Bank) -> None:
        self.joint, self.bank = joint, bank
        self.profiles: dict[int, Profile] = {
            i: on_joint(p, joint) for i, p in enumerate(bank.profiles) if p.kind != "always"
        }
        self._learners: dict[int, RegionLearner] = {}

    def look(self, observer: Observer, j: int, belief: Belief, memories: Iterable[Belief]) -> None:
        """Collect sightings of the effects that are believed in or remembered, and show enough to tell.

        Args:
            observer: What is seen now.
            j: The joint's index.
            belief: What is believed.
            memories: What is remembered.
        """
        y, residual = observer.filtered[j], float(observer.residual[j])
        threshold = VISIBLE * float(observer.threshold[j])
        for one in (belief, *memories):
            for i in self.bank.members(one.mask):
                if i in self.profiles:
                    continue
                span = self.bank.span(i)
                own = float(one.theta[span] @ y[span])
                if abs(own) <= threshold:  # both are 0 where the filters have just begun
                    continue
                others = float(observer.believed[j] @ y) - (own if one.mask & belief.mask else 0.0)
                learner = self._learners.setdefault(i, RegionLearner(self.joint))
                learner.add((residual - others) / own, float(observer.q[j]), float(observer.v[j]))

    def region(self, i: int) -> Region | None:
        """Return where an effect was seen, if that tells a region from the rest of the motion."""
        return self._learners[i].region if i in self._learners else None

    def confine(self, effects: Iterable[int]) -> None:
        """Hold effects for present only in the regions where they were seen; those must be known."""
        for i in effects:
            region = self.region(i)
            assert region is not None
            self.profiles[i] = region

    def terms(self, mask: int, theta: Array, ci95: Array | None = None) -> tuple[Term, ...]:
        """Return effects with sizes and profiles.

        Args:
            mask: The effects, one bit each.
            theta: Parameters of all effects of the bank, shape (P,).
            ci95: Intervals of those of the given effects, shape (p, 2).
        """
        terms, at = [], 0
        for i in self.bank.members(mask):
            effect = self.bank.effect(i, self.joint)
            own = None if ci95 is None else ci95[at : at + effect.size]
            interval = None if own is None else tuple((float(a), float(b)) for a, b in own)
            at += effect.size
            term = Term(effect, tuple(theta[self.bank.span(i)]), ci95=interval)
            profile = self.profiles.get(i) or self.region(i)
            terms.append(term if profile is None else replace(term, profile=profile))
        return tuple(terms)
