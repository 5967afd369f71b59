"""Efforts that are magnitudes: their sign was lost where they were recorded.

Many servos report the size of their current alone. A torque that changes its sign is then folded at zero: it comes
down to zero, is never beyond it, and leaves it as fast as it came. A torque that has one sign by itself may come near
zero too, but it turns there, and noise takes it beyond now and then.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.log import Log
from cdia_pin.logs.resolution import quantum

Array = NDArray[np.float64]

# There are two folds at most in 200 logs of fifteen arms with signed efforts. In 15 logs of four arms without signs
# some joint has four or more; five would miss one log.
FOLDS = 4  # [1], number of folds of a joint from which its effort is a magnitude
LARGE = 95.0  # [%] of the samples are below the effort to which the next two numbers refer
NEAR = 0.05  # [1], over that effort, below which an effort is near zero
AWAY = 0.25  # [1], over that effort, above which it is away from zero; between two folds it must be
BESIDE = 2  # samples [1] on each side by which a fold is told from noise near zero
FINEST = 8.0  # [1], that effort in steps of its rounding, from which folds prove it; one of few steps often reads zero


def folds(effort: Array) -> int:
    """Count how often an effort of one sign comes down to zero and leaves it as fast [1].

    Args:
        effort: Effort of a joint [N·m or N], shape (N,).

    Returns:
        The number; zero for an effort of both signs.
    """
    if effort.min() < 0 < effort.max():
        return 0
    size = np.abs(effort)
    large = np.percentile(size, LARGE)
    step = np.abs(np.diff(size, prepend=size[0]))
    reaches = size <= np.maximum(step, np.append(step[1:], 0.0))  # zero is no farther than the next sample
    at = np.flatnonzero((size <= NEAR * large) | (size > AWAY * large))
    away = size[at] > AWAY * large
    if not away.any():
        return 0
    visit = np.cumsum(away)  # samples near zero between the same two samples away from it
    between = ~away & (visit > 0) & (visit < visit[-1])
    return len(np.unique(visit[between & reaches[at] & _turns_sign(size, at)]))


def _turns_sign(size: Array, at: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Tell whether an effort goes straight on at some samples if its sign is other after them, shape of ``at``.

    Two samples before and two after must be nearer to a line then. A noisy effort that stays near zero is not.

    Args:
        size: Magnitude of the effort, shape (N,).
        at: Indices of the samples.
    """
    if len(size) <= 2 * BESIDE:
        return np.zeros(len(at), bool)
    middle = np.clip(at, BESIDE, len(size) - 1 - BESIDE)
    steps = np.array([k for k in range(-BESIDE, BESIDE + 1) if k])
    around = size[middle[:, None] + steps]
    line = np.column_stack([np.ones(len(steps)), steps])
    off_line = np.eye(len(steps)) - line @ np.linalg.pinv(line)
    turned = around * -np.sign(steps)
    return np.asarray(((turned @ off_line) ** 2).sum(axis=1) < ((around @ off_line) ** 2).sum(axis=1))


def unsigned(log: Log) -> NDArray[np.bool_]:
    """Return True for joints whose effort is a magnitude, shape (n,).

    One joint whose effort is fine enough must prove it. A recorder that drops one sign drops others too, so every joint
    that is folded once is taken as a magnitude then.

    Args:
        log: The log.
    """
    count = np.array([folds(x) for x in log.effort.T])
    proven = any(_is_fine(log.effort[:, k]) for k in np.flatnonzero(count >= FOLDS))
    return (count > 0) & proven


def _is_fine(effort: Array) -> bool:
    return bool(np.percentile(np.abs(effort), LARGE) >= FINEST * quantum(effort))


def check_unsigned(log: Log, joints: NDArray[np.bool_]) -> Iterator[Finding]:
    """Report joints whose effort is a magnitude.

    Args:
        log: The log.
        joints: True for these joints, shape (n,).

    Yields:
        A finding, if there are such joints.
    """
    names = [log.joints[k] for k in np.flatnonzero(joints)]
    if not names:
        return
    yield Finding(
        Topic.SIGN,
        Severity.ERROR,
        f"the effort of {', '.join(names)} comes down to zero again and again and is never beyond it: it is the size "
        "of a torque or current, and its sign is lost",
        joint=names[0] if len(names) == 1 else None,
        advice="record efforts with their sign; a servo may report it in a bit of its own",
        value={"joints": names},
    )
