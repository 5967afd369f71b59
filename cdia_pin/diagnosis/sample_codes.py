"""Why a sample cannot be, one number each, and the signals that a number is about."""

from __future__ import annotations

POSITION, VELOCITY, TORQUE = 0, 1, 2  # signals, added to the codes of a signal

GOOD = 0  # the sample follows from the one before
TIME_IMPOSSIBLE = 1  # the time is not a finite number
TIME_BACK = 2  # the time is earlier than that of the sample before
TIME_TWICE = 3  # the time is that of the sample before, or too little later
GAP = 4  # the time is so much later that nothing can be said about what happened in between
OUTSIDE = 10  # + signal: not finite, or beyond the limits of the arm
JUMP = 20  # + signal: no acceleration makes such a step
FROZEN = 30  # + signal: the value stays the same while the arm moves
DISAGREE = 41  # velocity and position contradict each other, a little at each sample
ZEROED = 50  # + signal: zero on all joints at once
NO_SIGNAL = 3  # a signal of the codes of time

CODES_PER_KIND = 10  # codes [1] from one kind to the next: the last digit is the signal
LATEST = 1e10  # [s], 300 years: a later time is none, and numbers near it could not tell two ticks apart


def kind_of(code: int) -> int:
    """Return a code without its signal.

    Args:
        code: One of the codes of this module, with its signal.
    """
    return code if code < OUTSIDE else code - code % CODES_PER_KIND


def signal_of(code: int) -> int:
    """Return the signal of a code; `NO_SIGNAL` for those of time.

    Args:
        code: One of the codes of this module, with its signal.
    """
    return NO_SIGNAL if code < OUTSIDE else code % CODES_PER_KIND


def is_evidence(code: int) -> bool:
    """Whether a code needed many samples, so that it accuses a sensor by itself.

    Args:
        code: One of the codes of this module, with its signal.
    """
    return kind_of(code) in (FROZEN, kind_of(DISAGREE))
