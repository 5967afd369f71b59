"""What was seen of one joint since something happened to it, and what the bank makes of that."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.belief import Belief
from cdia_pin.diagnosis.isolation import Decision, Isolator
from cdia_pin.diagnosis.learning import Healthy
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.status import Verdict

Array = NDArray[np.float64]

REMEMBERED = 1.0  # [s], how long a belief counts as measured when the next fault comes
ENOUGH = 6.0  # correlation times of a healthy residual, that a decision is based on
MOST_WAITED = 0.4  # [1], share of the memory that is waited for at most


class Evidence:
    """The normal equations of a joint, beside what was believed when they began.

    Args:
        j: The joint.
        observer: Collects the normal equations.
        isolator: Decides between effects.
        healthy: What a healthy joint is like.

    Attributes:
        last: The last decision; None before the first.
    """

    def __init__(self, j: int, observer: Observer, isolator: Isolator, healthy: Healthy) -> None:
        self.j, self.observer, self.isolator = j, observer, isolator
        self.level = float(healthy.level[j])
        self.independent = float(healthy.memory[j]) / observer.dt  # ticks
        self.last: Decision | None = None
        self.rely_on_nothing()

    @property
    def gram(self) -> Array:
        """Gram matrix of [y; r], upper triangle."""
        return self.observer.gram[self.j]

    @property
    def weight(self) -> float:
        """Number of samples in it; old ones count less."""
        return float(self.observer.joint[self.observer.k.WEIGHT, self.j])

    @property
    def is_enough(self) -> bool:
        """Whether there are samples enough to decide."""
        memory = self.observer.settings.memory / self.observer.dt
        return self.weight >= min(ENOUGH * self.independent, MOST_WAITED * memory)

    def restart(self, beside: Belief | None = None) -> None:
        """Begin anew.

        Args:
            beside: Held for measured, so that what comes next is decided upon beside it.
        """
        self.rely_on_nothing()
        if beside is not None:
            bank = self.isolator.bank
            columns = bank.columns(bank.members(beside.mask))
            energy = np.diag(self.gram)[columns] / max(self.weight, 1.0)
            self._prior[columns] = energy * REMEMBERED / self.observer.dt
            self._centre = beside.theta
        self.observer.restart_decision(self.j)

    def rely_on_nothing(self) -> None:
        """Hold nothing for measured but what is collected."""
        self._prior = np.zeros(self.isolator.bank.width)
        self._centre = np.zeros(self.isolator.bank.width)

    def reset(self) -> None:
        """Return to the start."""
        self.last = None
        self.end()

    def end(self) -> None:
        """Collect no more."""
        self.rely_on_nothing()
        self.observer.end_decision(self.j)

    def decide(self, required: int = 0) -> Decision:
        """Decide between combinations of effects that hold the required ones, one bit each."""
        self.last = self.isolator.decide(
            self.j,
            self.gram,
            max(self.weight, 1.0),
            self.level,
            self.independent,
            required=required,
            prior=self._prior,
            centre=self._centre,
        )
        return self.last

    def belief(self, decision: Decision, verdict: Verdict) -> Belief:
        """Return a decision for effects as a belief, with intervals."""
        assert decision.mask
        ci95 = self.isolator.intervals(
            decision.mask, decision.theta, self.gram, decision.noise, self.independent
        )
        return Belief(decision.theta, decision.mask, verdict, ci95, decision.rivals)


class Votes:
    """The last decisions on a joint: nothing is believed before they agree.

    Args:
        needed: How many must.
    """

    def __init__(self, needed: int) -> None:
        self._last: deque[tuple[int, bool]] = deque(maxlen=needed)

    def add(self, decision: Decision) -> None:
        """Add a decision."""
        self._last.append((decision.key, bool(decision.rivals)))

    def clear(self) -> None:
        """Forget all."""
        self._last.clear()

    @property
    def agree(self) -> bool:
        """Whether there are enough, and all are for the same."""
        return len(self._last) == self._last.maxlen and len({key for key, _ in self._last}) == 1

    @property
    def are_clear(self) -> bool:
        """Whether no combination rivalled the leading one in any."""
        return not any(ambiguous for _, ambiguous in self._last)
