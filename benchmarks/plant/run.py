"""What a run of the plant gives: the log that sensors recorded, and the truth beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.faults import Fault
from benchmarks.plant.noise import Noise
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]


class Truth(NamedTuple):
    """What the arm really did, shape (N, n) each: M q̈ + nle = effort + f holds at each sample.

    Attributes:
        time: Time [s], shape (N,).
        position: True positions [rad or m].
        velocity: True velocities [rad/s or m/s].
        acceleration: True accelerations [rad/s² or m/s²].
        effort: Commanded torques, without noise or delay [N·m or N].
        reference: Positions asked for [rad or m].
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    effort: Array
    reference: Array


@dataclass(frozen=True)
class Run:
    """One run of the plant.

    Attributes:
        log: What the sensors recorded.
        truth: What really happened.
        noise_std: Standard deviation of the torque noise [N·m or N], shape (n,).
        faults: What was hidden.
    """

    log: Log
    truth: Truth
    noise_std: Array
    faults: tuple[Fault, ...]


def record(
    exact: Mapping[str, Array],
    joints: tuple[str, ...],
    faults: tuple[Fault, ...],
    noise: Noise,
    *,
    rate: float,
    velocity: bool,
    rng: np.random.Generator,
    source: str,
) -> Run:
    """Add to a noise-free run what sensors do.

    Args:
        exact: The fields of `Truth`, and ``read_position`` or ``read_effort`` where a sensor is at fault.
        joints: Joint names.
        faults: What was hidden.
        noise: Imperfections of the sensors.
        rate: Sampling rate [Hz].
        velocity: Whether the log has velocities.
        rng: Source of the noise.
        source: What the log says of itself.
    """
    truth = Truth(*(exact[k] for k in Truth._fields))
    effort = noise.read_effort(exact.get("read_effort", truth.effort), rate, rng)
    velocities = truth.velocity + noise.velocity_std * rng.standard_normal(truth.velocity.shape)
    log = Log(
        joints=joints,
        time=truth.time,
        position=noise.read_position(exact.get("read_position", truth.position)),
        effort=effort,
        velocity=velocities if velocity else None,
        source=source,
    )
    return Run(log, truth, noise.std_of(truth.effort), faults)
