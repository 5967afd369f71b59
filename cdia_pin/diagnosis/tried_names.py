"""The names that the fault of a joint was given, and how many of them failed."""

from __future__ import annotations

from cdia_pin.diagnosis.stateful import Stateful

# A first name may be of the onset, and a fault that joins replaces one. With 2, simulated faults that join each other
# are named right in 90 % instead of 96 %; with 4, unknown ones are called unknown in 89 % instead of 92 %.
MOST_FAILURES = 3  # names [1] that failed, or gave way to another, after which the fault is called unknown
HOLDING_TIME = 10.0  # [s], some periods of a motion; what has held for so long ends the count of failures


class TriedNames(Stateful):
    """The name that is being tried, and those before it that failed.

    Attributes:
        tried: The name, one bit for each effect of the bank; 0 for none.
        failures: Number of names that failed.
    """

    STATE = ("tried", "failures")

    def __init__(self) -> None:
        self.tried = self.failures = 0

    def fail(self) -> bool:
        """Note that the last name was wrong, and return whether too many were."""
        self.tried, self.failures = 0, self.failures + 1
        return self.failures >= MOST_FAILURES

    def replace(self, mask: int) -> bool:
        """Try a name in the place of the last one, which has failed if it was another.

        Args:
            mask: The name, one bit for each effect.

        Returns:
            Whether too many have failed; the name is not tried then.
        """
        if self.tried not in (0, mask) and self.fail():
            return True
        self.tried = mask
        return False

    def forgive(self, held: float) -> None:
        """Count no failures if the present stage of the joint has lasted for long.

        Args:
            held: For how long [s].
        """
        if held >= HOLDING_TIME:
            self.tried = self.failures = 0
