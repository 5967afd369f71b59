"""What the monitor believes about one joint, and what it remembers; changes go to the observer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cdia_pin.diagnosis.approximation import Approximator
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.fault_memory import FaultMemory
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.presence import Presence
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Verdict
from cdia_pin.effects import Term, Unknown


class BeliefState(Stateful):
    """The belief about one joint: effects of the bank, or neurons where none of them fits.

    Args:
        j: The joint's index.
        observer: Subtracts the torque of what is believed from the residual.
        bank: The known effects.
        unknown: Neurons for an unknown fault.

    Attributes:
        now: What is believed.
        isolated: What was isolated last, of the size that it had then.
        memory: Cleared faults.
        neurons: What has been learned of an unknown fault.
        unknown_before: Whether a cleared unknown fault is remembered.
        presence: Where in the motion effects are present.
    """

    STATE = ("now", "isolated", "memory", "neurons", "unknown_before", "presence")

    def __init__(self, j: int, observer: MomentumObserver, bank: Bank, unknown: Unknown) -> None:
        self.j, self.observer, self.bank = j, observer, bank
        self.presence = Presence(observer.nominal.robot.joints[j], bank)
        self.memory = FaultMemory()
        self.neurons = Approximator(j, observer, unknown)
        self.unknown_before = False
        observer.state.present[j] = 1.0
        self.neurons.stop()
        self.now = self.isolated = JointBelief.nothing(bank)
        observer.state.absent[j] = 0.0
        observer.believe(j, self.now.theta)

    def hold(self, belief: JointBelief) -> None:
        """Believe in the effects of a belief, and in no others.

        Args:
            belief: The belief.
        """
        before, self.now, o = self.now, belief, self.observer
        o.believe(self.j, belief.theta)
        if belief.mask != before.mask:
            o.state.absent[self.j] *= np.array([belief.mask >> i & 1 for i in range(len(o.effects))])

    def commit(self, belief: JointBelief) -> None:
        """Believe in isolated effects; they are neither unknown nor cleared any longer.

        Args:
            belief: The isolated effects.
        """
        self.unknown_before = False
        self.neurons.disbelieve()
        self.memory.forget(belief.mask)
        self.isolated = belief
        self.hold(belief)

    def commit_unknown(self) -> None:
        """Believe in the learned torque, and in no effect."""
        self.neurons.believe()
        self.hold(JointBelief.nothing(self.bank, Verdict.UNKNOWN))

    def reconsider(self) -> None:
        """Keep the belief, but withdraw its verdict while a further fault is being isolated."""
        self.now = replace(self.now, verdict=Verdict.NONE)

    @property
    def remembers(self) -> bool:
        """Whether a cleared fault is remembered."""
        return self.unknown_before or len(self.memory) > 0

    def rest(self) -> None:
        """Believe in nothing; a remembered unknown fault goes on being learned."""
        self.hold(JointBelief.nothing(self.bank))
        if not self.unknown_before:
            self.neurons.stop()

    def recall(self) -> JointBelief | None:
        """Return the belief together with a remembered fault, if that has returned, or None."""
        fault = self.memory.recall(self.now, self.observer.state.gram[self.j])
        return None if fault is None else self.now.joined(fault)

    def look(self) -> None:
        """Collect where the believed and the remembered effects are present."""
        self.presence.look(self.observer, self.j, self.now, self.memory)

    # ------------------------------------------------------------- cleared faults

    def absent(self) -> list[int]:
        """Return the indices of the effects whose torque has stayed away where it would show."""
        ticks = self.observer.state.absent[self.j]
        return [i for i in self.bank.members(self.now.mask) if ticks[i] >= self.observer.absent_ticks]

    def come_and_go(self, effects: Sequence[int]) -> bool:
        """Return whether effects are absent because the motion has left the regions where they are present.

        Args:
            effects: Their indices.
        """
        return all(self.presence.region(i) is not None for i in effects)

    def confine(self, effects: Sequence[int]) -> None:
        """Keep effects, but only in the regions where they were seen.

        Args:
            effects: Their indices; their regions must be known.
        """
        self.presence.confine(effects)
        self.observer.state.absent[self.j] = 0.0

    def clear(self, effects: Sequence[int]) -> tuple[Term, ...]:
        """Remember effects instead of believing in them, and return them.

        Args:
            effects: Their indices.
        """
        cleared, left = self.now.parted(self.bank, effects)
        terms = self.presence.terms(cleared.mask, cleared.theta)
        self.memory.add(cleared)
        self.isolated = self.isolated.parted(self.bank, effects)[1]
        self.observer.state.absent[self.j] = 0.0
        self.hold(left)
        return terms

    def clear_unknown(self) -> None:
        """Remember an unknown fault instead of believing in it."""
        self.unknown_before = True
        self.neurons.disbelieve()
        self.rest()

    # ------------------------------------------------------------- what is reported

    @property
    def faults(self) -> tuple[Term, ...]:
        """Believed faults; an unknown one as its learned neurons."""
        if self.now.verdict is Verdict.UNKNOWN:
            return (self.neurons.term,)
        return self.presence.terms(self.now.mask, self.now.theta, self.now.ci95)

    @property
    def alternatives(self) -> tuple[tuple[Term, ...], ...]:
        """Other combinations that explain the residual equally well."""
        return tuple(self.presence.terms(mask, theta) for mask, theta in self.now.rivals)
