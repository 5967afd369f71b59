"""Where the efforts of a log come from: whether they were measured at all."""

from __future__ import annotations

from enum import StrEnum


class EffortOrigin(StrEnum):
    """Where the efforts of a log come from."""

    MEASURED = "measured"
    COMPENSATED = "compensated"  # the controller took its own gravity away; the URDF's was added back
    COMMANDED = "commanded"  # what a controller asked for; nothing was measured
