"""What healthy runs teach about the whole arm: how far joints leave their course, and what lasts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import Alignment
from cdia_pin.diagnosis.growth import growth
from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.lasting import LastingDetector, limit_of
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.moving_residual import LEAST_MOTION
from cdia_pin.diagnosis.residuals import along, pooled
from cdia_pin.diagnosis.whole_arm.contact import ContactDetector, ContactLimits
from cdia_pin.diagnosis.whole_arm.contact_kernel import RESTING
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

PERIOD = 0.01  # [s] between two samples of the detectors: an arm's filters let nothing faster through
LIGHTEST = 1e-3  # [1], least torque of a joint that counts, over the largest of the arm: some carry nothing
TINY = 1e-6  # [N·m or N], that of an arm that carries nothing
LEAST_REST = 2.0  # [s] at rest, from which healthy runs say what a joint does there
LEAST_DEVIATION = 0.02  # [1], least limit of a deviation over the RMS torque of the joint


@dataclass(frozen=True)
class Learned:
    """What healthy runs taught.

    Attributes:
        healthy: The healthy arm.
        contact: Limits of the deviations.
        lasting: Limit of the explained torque [N·m or N], shape (n, N).
    """

    healthy: HealthyArm
    contact: ContactLimits
    lasting: Array


def learn(
    observer: MomentumObserver,
    alignment: Alignment,
    lasting: LastingDetector,
    runs: Sequence[Log],
    healthy: HealthyArm,
) -> Learned:
    """Watch the detectors along runs of the healthy arm.

    Args:
        observer: Its filters are used; they forget the runs.
        alignment: The same.
        lasting: The second detector; it forgets the runs.
        runs: Logs of the healthy arm.
        healthy: What else is known of the healthy arm.
    """
    n, settings = observer.nominal.robot.n, observer.settings
    rest, moving, resting, moved = (np.zeros(n) for _ in range(4))
    zero = np.zeros(n)  # No energy of the torque is used here, and no effect is believed.
    largest, friction = np.zeros_like(lasting.limit), np.zeros(n)
    for run in runs:
        detector = ContactDetector(_without_limits(n))
        lasting.reset()
        last = -np.inf
        for t, is_settled in along(observer, alignment, run):
            if t < last + PERIOD:
                continue
            dt, last = (t - last if last > -np.inf else 0.0), t
            if not is_settled:
                continue
            share = observer.state.moving
            friction = np.maximum(friction, observer.state.known_amplitude)
            detector.add(observer.time, dt, observer.remainder, share, observer.state.nle, zero)
            off = np.abs(detector.deviation)
            moving = np.maximum(moving, np.where(share < RESTING, 0.0, off))
            rest = np.maximum(rest, np.where(share < RESTING, off, 0.0))
            resting += dt * (share < RESTING)
            moved += dt * (share >= RESTING)
            lasting.add(dt, observer.filtered, observer.remainder, zero, observer.state.steady)
            largest = np.maximum(largest, lasting.explained())
    observer.reset()
    alignment.reset()
    lasting.reset()
    torque = pooled([run.effort for run in runs])
    least = LEAST_DEVIATION * np.maximum(torque, LIGHTEST * max(float(torque.max()), TINY))
    moving = np.maximum(settings.margin * growth(moved, healthy.memory) * moving, least)
    is_known = moved >= LEAST_MOTION
    moving = np.where(is_known, moving, np.maximum(moving, healthy.rest_bound))
    known = np.maximum(settings.margin * growth(resting, healthy.memory) * rest, least)
    rest = np.where(resting >= LEAST_REST, known, moving)
    moving = np.maximum(moving, rest)
    limit = limit_of(largest, moved, settings.memory, settings.false_alarm_every, torque)
    limit[~is_known] = np.inf  # nothing is known of a joint that did not move
    return Learned(healthy, ContactLimits(rest, moving, friction), limit)


def assumed(n: int, width: int, healthy: HealthyArm) -> Learned:
    """Return what a given threshold says: a joint is off its course beyond it, and nothing is known of what lasts.

    Args:
        n: Number of joints.
        width: Number of effects of the bank.
        healthy: What the threshold says of the arm.
    """
    limits = ContactLimits(healthy.bound, healthy.bound, np.zeros(n))
    return Learned(healthy, limits, np.full((n, width), np.inf))


def _without_limits(n: int) -> ContactLimits:
    without = np.full(n, np.inf)
    return ContactLimits(without, without, np.zeros(n))
