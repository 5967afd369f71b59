"""Presence of the effects of one joint in the motion: as the bank states it, or as it was seen."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank, on_joint
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.region import RegionLearner
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.effects import Profile, Region, Term

Array = NDArray[np.float64]

SIGHTING = 1.5  # [1], torque of an effect over the threshold, above which a look shows whether it is present


class Presence(Stateful):
    """Profiles of the effects of a joint.

    Args:
        joint: Name of the joint.
        bank: The known effects.

    Attributes:
        profiles: Profiles of the effects that are not always present, by index; they are corrected only where present.
    """

    STATE = ("profiles", "_learners")

    def __init__(self, joint: str, bank: Bank) -> None:
        self.joint, self.bank = joint, bank
        self.profiles: dict[int, Profile] = {
            i: on_joint(p, joint) for i, p in enumerate(bank.profiles) if p.kind != "always"
        }
        self._learners: dict[int, RegionLearner] = {}
        self._effects = tuple(bank.effect(i, joint) for i in range(len(bank)))
        self._columns = tuple(bank.columns([i]).tolist() for i in range(len(bank)))

    def new_part(self, name: str) -> RegionLearner:
        """Make a learner, of which there is one for each effect that was seen."""
        return RegionLearner(self.joint)

    def look(
        self, observer: MomentumObserver, j: int, belief: JointBelief, memories: Iterable[JointBelief]
    ) -> None:
        """Collect sightings of the believed and the remembered effects, where their torque is large enough.

        Args:
            observer: Its residual, columns and motion of this tick.
            j: The joint's index.
            belief: What is believed.
            memories: Cleared faults.
        """
        y, residual = observer.filtered[j].tolist(), float(observer.residual[j])
        threshold = SIGHTING * float(observer.threshold[j])
        for one in (belief, *memories):
            for i in self.bank.members(one.mask):
                if i in self.profiles:
                    continue
                own = sum(float(one.theta[k]) * y[k] for k in self._columns[i])
                if abs(own) <= threshold:  # both are 0 where the filters have just started
                    continue
                all_believed = sum(
                    c * own_y for c, own_y in zip(observer.believed[j].tolist(), y, strict=True)
                )
                others = all_believed - (own if one.mask & belief.mask else 0.0)
                learner = self._learners.setdefault(i, RegionLearner(self.joint))
                learner.add((residual - others) / own, float(observer.q[j]), float(observer.v[j]))

    def region(self, i: int) -> Region | None:
        """Return the region in which an effect is present, or None if what was seen does not show one.

        Args:
            i: The effect's index.
        """
        return self._learners[i].region if i in self._learners else None

    def confine(self, effects: Iterable[int]) -> None:
        """Take effects as present only in the regions where they were seen.

        Args:
            effects: Their indices; their regions must be known.
        """
        for i in effects:
            region = self.region(i)
            assert region is not None
            self.profiles[i] = region

    def terms(self, mask: int, theta: Array, ci95: Array | None = None) -> tuple[Term, ...]:
        """Return effects with parameters and profiles.

        Args:
            mask: The effects, one bit each.
            theta: Parameters of all effects of the bank, shape (P,).
            ci95: 95 % intervals of the parameters of the given effects, shape (p, 2).
        """
        terms, at = [], 0
        for i in self.bank.members(mask):
            effect = self._effects[i]
            own = None if ci95 is None else ci95[at : at + effect.size]
            interval = None if own is None else tuple((float(a), float(b)) for a, b in own)
            at += effect.size
            term = Term(effect, tuple(theta[self.bank.span(i)]), ci95=interval)
            profile = self.profiles.get(i) or self.region(i)
            terms.append(term if profile is None else replace(term, profile=profile))
        return tuple(terms)
