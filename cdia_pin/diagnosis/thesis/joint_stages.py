"""The stages of all joints, from what the engine knows about them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.status import Stage

Mask = NDArray[np.bool_]


def joint_stages(
    *, isolating: Mask, undecided: bool, acting: Mask, beyond: Mask, cleared: Mask, accommodate: bool
) -> tuple[Stage, ...]:
    """Return the stage of each joint.

    Args:
        isolating: Joints with a detected fault that is being isolated, shape (n,).
        undecided: Whether isolation has announced no result yet.
        acting: Joints on which an isolated effect acts, shape (n,).
        beyond: Joints whose residual is beyond its threshold, shape (n,).
        cleared: Joints with a fault that has cleared, shape (n,).
        accommodate: Whether torques are corrected.
    """
    known = Stage.ACCOMMODATED if accommodate else Stage.ISOLATED
    open_ = Stage.DETECTED if undecided or not accommodate else Stage.ACCOMMODATED
    stages = (open_, known, Stage.SUSPECT, Stage.IDLE)  # the gravest first
    of_each = zip(*(which.tolist() for which in (isolating, acting, beyond, cleared)), strict=True)
    return tuple(
        next((stage for stage, is_so in zip(stages, each, strict=True) if is_so), Stage.HEALTHY)
        for each in of_each
    )
