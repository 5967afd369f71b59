"""What is believed of one joint, and what is remembered; the observer is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cdia_pin.diagnosis.approximation import Approximator
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.belief import Belief
from cdia_pin.diagnosis.memories import Memories
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.presence import Presence
from cdia_pin.diagnosis.status import Verdict
from cdia_pin.effects import Term, Unknown


class Beliefs:
    """The belief of one joint: effects of the bank, or neurons for what none of them explains.

    Args:
        j: The joint.
        observer: Takes what is believed from the residual.
        bank: The known effects.
        unknown: Neurons for what no effect explains.

    Attributes:
        now: What is believed.
        memories: Faults that are gone.
        neurons: What has been learned of an unknown torque.
        unknown_before: Whether an unknown torque is remembered.
        presence: Where in the motion effects are present.
    """

    def __init__(self, j: int, observer: Observer, bank: Bank, unknown: Unknown) -> None:
        self.j, self.observer, self.bank = j, observer, bank
        self.presence = Presence(observer.nominal.robot.joints[j], bank)
        self.memories = Memories()
        self.neurons = Approximator(j, observer, unknown)
        self.unknown_before = False
        observer.columns[observer.k.PRESENT, j] = 1.0
        self.neurons.stop()
        self.hold(Belief.nothing(bank))

    def hold(self, belief: Belief) -> None:
        """Believe in these effects, and no others."""
        self.now = belief
        o = self.observer
        o.believe(self.j, belief.theta)
        o.absent[self.j] *= np.array([belief.mask >> i & 1 for i in range(len(o.effects))])

    def commit(self, belief: Belief) -> None:
        """Believe in effects that have been isolated: neither are they unknown, nor gone."""
        self.unknown_before = False
        self.neurons.disbelieve()
        self.memories.forget(belief.mask)
        self.hold(belief)

    def commit_unknown(self) -> None:
        """Believe in what the neurons have learned, and no effects."""
        self.neurons.believe()
        self.hold(Belief.nothing(self.bank, Verdict.UNKNOWN))

    def reconsider(self) -> None:
        """Keep what is believed, but say nothing of it while something else is being decided."""
        self.now = replace(self.now, verdict=Verdict.NONE)

    @property
    def remembers(self) -> bool:
        """Whether a fault that is gone is remembered."""
        return self.unknown_before or len(self.memories) > 0

    def rest(self) -> None:
        """Believe nothing; an unknown torque that was there goes on being learned."""
        self.hold(Belief.nothing(self.bank))
        if not self.unknown_before:
            self.neurons.stop()

    def recall(self) -> Belief | None:
        """Return what is believed together with a remembered fault, if that has returned."""
        memory = self.memories.recall(self.now, self.observer.gram[self.j])
        return None if memory is None else self.now.joined(memory)

    def look(self) -> None:
        """Look where the effects that are believed in or remembered are present."""
        self.presence.look(self.observer, self.j, self.now, self.memories)

    # ------------------------------------------------------------- what is gone

    def absent(self) -> list[int]:
        """Return the effects whose torque has stayed away where it would show."""
        away = self.observer.absent[self.j]
        return [i for i in self.bank.members(self.now.mask) if away[i] >= self.observer.idle_ticks]

    def come_and_go(self, effects: Sequence[int]) -> bool:
        """Tell whether effects are away because the motion has left the regions where they are present."""
        return all(self.presence.region(i) is not None for i in effects)

    def confine(self, effects: Sequence[int]) -> None:
        """Keep effects, present only in the regions where they were seen."""
        self.presence.confine(effects)
        self.observer.absent[self.j] = 0.0

    def drop(self, effects: Sequence[int]) -> tuple[Term, ...]:
        """Remember effects in place of believing in them; returns them."""
        gone, left = self.now.parted(self.bank, effects)
        terms = self.presence.terms(gone.mask, gone.theta)
        self.memories.add(gone)
        self.observer.absent[self.j] = 0.0
        self.hold(left)
        return terms

    def drop_unknown(self) -> None:
        """Remember an unknown torque in place of believing in it."""
        self.unknown_before = True
        self.neurons.disbelieve()
        self.rest()

    # ------------------------------------------------------------- what is said

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults believed in; what is unknown as its learned neurons."""
        if self.now.verdict is Verdict.UNKNOWN:
            return (self.neurons.term,)
        return self.presence.terms(self.now.mask, self.now.theta, self.now.ci95)

    @property
    def alternatives(self) -> tuple[tuple[Term, ...], ...]:
        """Other combinations that explain the same."""
        return tuple(self.presence.terms(mask, theta) for mask, theta in self.now.rivals)
