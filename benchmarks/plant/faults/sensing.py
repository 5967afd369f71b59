"""Signals that do not say what they should; the plant applies them to what it reads and records."""

from __future__ import annotations

from benchmarks.plant.faults.mechanism import Mechanism


class EncoderOffset(Mechanism):
    """q = q_read + offset: controller and log see the reading."""

    name = "encoder_offset"
    defaults = {"offset": 0.01}  # [rad or m]
    sizes = ("offset",)


class EffortDelay(Mechanism):
    """τ_recorded(t) = τ(t − delay), on one joint or all."""

    name = "effort_delay"
    defaults = {"delay": 0.01}  # [s]
    sizes = ("delay",)
    places = None
