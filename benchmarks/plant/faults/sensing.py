"""Signals that do not say what they should; the plant applies them to what it reads and records."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from benchmarks.plant.faults.mechanism import Fault, Mechanism, Parameters
from cdia_pin.errors import EffectError


class Reading(Mechanism):
    """A sensor at fault from beginning to end."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault)
        if fault.after > -np.inf or fault.until < np.inf:
            raise EffectError(
                f"plant, {fault.effect}: a sensor's fault is there all the time, not after a time"
            )


class EncoderOffset(Reading):
    """q = q_read + offset: controller and log see the reading."""

    name = "encoder_offset"
    defaults: ClassVar[Parameters] = {"offset": 0.01}  # [rad or m]
    sizes = ("offset",)


class EffortDelay(Reading):
    """τ_recorded(t) = τ(t − delay), on one joint or all."""

    name = "effort_delay"
    defaults: ClassVar[Parameters] = {"delay": 0.01}  # [s]
    sizes = ("delay",)
    places = None
