"""The range of each number that an option takes. Beyond it there is no arm, no log or no time to wait for it.

A number is refused before anything is read or computed. What a number within its range must fulfil besides, such as a
cut-off below the rate of the log, is said by what needs it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer


def within(least: float, most: float, unit: str = "", zero: bool = False) -> Callable[[Any], Any]:
    """Return a callback of an option that refuses numbers outside a range, infinite ones and NaN.

    Args:
        least: Smallest number.
        most: Largest number.
        unit: Unit, for the message.
        zero: Whether zero has a meaning of its own, and may be given too.
    """
    said = f"must be {'0, or ' if zero else ''}{least:g} to {most:g}{f' {unit}' if unit else ''}"

    def checked(value: Any) -> Any:
        for number in value if isinstance(value, list) else [value]:
            if number is not None and not (least <= number <= most or (zero and number == 0)):
                raise typer.BadParameter(f"{said}, given {number:g}")
        return value

    return checked


CUTOFF = within(1e-3, 1e5, "Hz")  # a period of a quarter of an hour; faster than any drive samples
DURATION = within(0.01, 1e5, "s")  # a hundredth of a second to a day
RATE = within(0.1, 1e5, "Hz")  # no drive records faster
SHARE = within(0.0, 10.0)  # noise of ten times the signal leaves nothing of it
MODEL_ERROR = within(0.0, 0.5)  # of an inertia; a centre of mass further off leaves its link
LIMIT_SHARE = within(1e-3, 1.0)  # of a limit of the arm
PACE = within(1e-3, 1e3, zero=True)  # seconds shown in a second; 0 waits for nothing
MASS = within(1e-3, 1e4, "kg")  # that an arm can carry
LENGTH = within(0.0, 10.0, "m")  # larger than an arm
FALSE_ALARMS = within(1e-9, 1e9)
SEED = within(0, 2**63 - 1)  # what a file of any kind can hold
COUNT = within(0, 2**31 - 1)  # of episodes and runs
WORKERS = within(1, 4096)  # processes of one machine
PORT = within(0, 65535)  # of TCP; 0 is any free one
