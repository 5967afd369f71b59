"""Isolation on one joint: its normal equations since the detection, and the decisions that they lead to."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.isolation import Decision, Isolator
from cdia_pin.diagnosis.joint_gram import TINY, gram_parts
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Verdict

Array = NDArray[np.float64]

BELIEF_WORTH = 1.0  # [s] of measurement that an old belief counts as when the next fault comes
CORRELATION_TIMES = 6.0  # [1], correlation times of a healthy residual that a decision needs
# On a measured arm that met a motion unlike its healthy one, three parameters followed the error of the model for three
# independent samples. Asked for the first parameter too, two samples cost 6 of 102 measured cases their right name.
SAMPLES_PER_PARAMETER = 2.0  # [1], independent samples for each new parameter of a name after its first
MEMORY_SHARE = 0.4  # [1], share of the memory after which a decision is taken at the latest


class JointIsolation(Stateful):
    """The normal equations of a joint, beside what was believed when they started.

    Args:
        j: The joint's index.
        observer: Collects the normal equations.
        isolator: Decides between effects.
        healthy: What is known of the healthy arm.

    Attributes:
        last: The last decision; None before the first.
    """

    STATE = ("last", "_prior", "_centre")

    def __init__(self, j: int, observer: MomentumObserver, isolator: Isolator, healthy: HealthyArm) -> None:
        self.j, self.observer, self.isolator = j, observer, isolator
        self.level = float(healthy.level[j])
        self.independent = float(healthy.moving_memory[j]) / observer.dt  # [samples]
        self._alike = float(healthy.independent[j]) / observer.dt  # [samples], for intervals
        self.last: Decision | None = None
        self.drop_prior()

    @property
    def gram(self) -> Array:
        """Gram matrix of [y; r], upper triangle, shape (P + 1, P + 1)."""
        return np.asarray(self.observer.state.gram[self.j])

    @property
    def weight(self) -> float:
        """Number of samples in it, old ones discounted [1]."""
        return float(self.observer.state.weight[self.j])

    @property
    def is_enough(self) -> bool:
        """Whether there are enough samples to decide."""
        memory = self.observer.settings.memory / self.observer.dt
        return self.weight >= min(CORRELATION_TIMES * self.independent, MEMORY_SHARE * memory)

    def restart(self, beside: JointBelief | None = None) -> None:
        """Start the normal equations again.

        Args:
            beside: A belief that counts as measured, so that what comes next is decided beside it.
        """
        self.drop_prior()
        if beside is not None:
            bank = self.isolator.bank
            columns = bank.columns(bank.members(beside.mask))
            energy = np.diag(self.gram)[columns] / max(self.weight, 1.0)
            self._prior[columns] = energy * BELIEF_WORTH / self.observer.dt
            self._centre = beside.theta
        self.observer.restart_decision(self.j)

    def drop_prior(self) -> None:
        """Count nothing as measured but the collected samples."""
        self._prior = np.zeros(self.isolator.bank.width)
        self._centre = np.zeros(self.isolator.bank.width)

    def reset(self) -> None:
        """Return to the start."""
        self.last = None
        self.end()

    def end(self) -> None:
        """Collect no more samples."""
        self.drop_prior()
        self.observer.end_decision(self.j)

    def decide(self, required: int = 0, caused: bool = False, afresh: bool = False) -> Decision:
        """Decide between the combinations that contain the required effects.

        Args:
            required: The effects, one bit each.
            caused: Whether it is certain that something is there.
            afresh: Whether what was believed counts for nothing.
        """
        self.last = self.isolator.decide(
            self.j,
            self.gram,
            max(self.weight, 1.0),
            self.level,
            self.independent,
            required=required,
            prior=None if afresh else self._prior,
            centre=None if afresh else self._centre,
            caused=caused,
        )
        return self.last

    def is_less_without(self, belief: JointBelief) -> bool:
        """Tell whether the collected samples have less residual without a belief than with it: its fault has gone.

        Args:
            belief: A belief in at least one effect.
        """
        parts = gram_parts(self.gram, self.isolator.bank.width)
        return parts.energy < parts.left(belief.theta)

    def determines(self, decision: Decision) -> bool:
        """Tell whether there are enough independent samples for the parameters of a decision that are new.

        Args:
            decision: A decision for at least one effect.
        """
        assert decision.mask
        bank = self.isolator.bank
        new = int((self._prior[bank.columns(bank.members(decision.mask))] == 0.0).sum())
        return self.weight >= SAMPLES_PER_PARAMETER * (new - 1) * self.independent

    def explained(self, decision: Decision) -> float:
        """Return the share of the residual's mean square that a decision explains, beside what was believed [1].

        Args:
            decision: A decision.
        """
        parts = gram_parts(self.gram, self.isolator.bank.width)
        return 1.0 - parts.left(decision.theta) / max(parts.left(self._centre), TINY)

    def belief(self, decision: Decision, verdict: Verdict) -> JointBelief:
        """Return a decision as a belief, with intervals.

        Args:
            decision: A decision for at least one effect.
            verdict: Whether it is the only explanation.
        """
        assert decision.mask
        ci95 = self.isolator.intervals(decision.mask, decision.theta, self.gram, decision.noise, self._alike)
        return JointBelief(decision.theta, decision.mask, verdict, ci95, decision.rivals)


class Votes(Stateful):
    """The last decisions on a joint: the monitor acts when they agree.

    Args:
        needed: Number of decisions in a row that must agree.
    """

    STATE = ("_last",)

    def __init__(self, needed: int) -> None:
        self._last: deque[tuple[int, bool]] = deque(maxlen=needed)

    def add(self, decision: Decision) -> None:
        """Add a decision.

        Args:
            decision: The newest one; the oldest is dropped.
        """
        self._last.append((decision.key, bool(decision.rivals)))

    def clear(self) -> None:
        """Drop all decisions."""
        self._last.clear()

    @property
    def agree(self) -> bool:
        """Whether there are enough decisions, all for the same combination."""
        return len(self._last) == self._last.maxlen and len({key for key, _ in self._last}) == 1

    @property
    def are_clear(self) -> bool:
        """Whether no decision had a rival."""
        return not any(ambiguous for _, ambiguous in self._last)

    @property
    def are_sure(self) -> bool:
        """Whether all decisions are for the same combination, and none had a rival."""
        return self.agree and self.are_clear
