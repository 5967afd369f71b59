"""What a monitor can see: the threshold of each joint beside the torque of healthy motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import some

Array = NDArray[np.float64]

# [1], threshold over RMS torque above which a joint is blind: a drive that has lost 30 % of its torque then stays below
# the threshold most of the time, and smaller faults always
BLIND_SHARE = 0.3


class JointSight(TypedDict):
    """What a monitor can see of a joint; plain JSON.

    Attributes:
        threshold: Bound of a healthy residual [N·m or N].
        torque_rms: RMS torque of healthy motion [N·m or N]; None if it is not known.
        share: Threshold over RMS torque [1]; None if that is not known, or the joint needs no torque.
        blind: Whether a fault of 30 % of the torque could not be seen.
    """

    threshold: float
    torque_rms: float | None
    share: float | None
    blind: bool


@dataclass(frozen=True)
class Sight:
    """Thresholds beside torques.

    Attributes:
        joints: Names of the joints.
        threshold: Bound of a healthy residual [N·m or N], shape (n,).
        torque: RMS torque of healthy motion [N·m or N], shape (n,); not a number where it is not known.
    """

    joints: tuple[str, ...]
    threshold: Array
    torque: Array

    @property
    def blind(self) -> tuple[str, ...]:
        """Names of the joints on which a fault of 30 % of the torque could not be seen."""
        unseen = self.threshold > BLIND_SHARE * self.torque  # never, where the torque is not known
        return tuple(j for j, one in zip(self.joints, unseen, strict=True) if one)

    def to_dict(self) -> dict[str, JointSight]:
        """Return what is known of each joint, by its name."""
        blind = self.blind
        out: dict[str, JointSight] = {}
        for joint, bound, torque in zip(
            self.joints, self.threshold.tolist(), self.torque.tolist(), strict=True
        ):
            out[joint] = {
                "threshold": bound,
                "torque_rms": torque if np.isfinite(torque) else None,
                "share": bound / torque if torque > 0 else None,
                "blind": joint in blind,
            }
        return out


def blind_joints(sight: Mapping[str, JointSight]) -> list[str]:
    """Return the names of the joints that are blind.

    Args:
        sight: What is known of each joint, by its name.
    """
    return [joint for joint, one in sight.items() if one["blind"]]


def blind_advice(blind: Sequence[str], model_has_terms: bool) -> str:
    """Return a sentence on the joints that are blind, and what to do; empty if none is.

    Args:
        blind: Their names.
        model_has_terms: Whether the model holds more than the rigid bodies of the URDF.
    """
    if not blind:
        return ""
    cure = "give more healthy motion, or a model that explains more of it"
    if not model_has_terms:
        cure = (
            "give the model that cdia discover, or in seconds cdia identify, finds on a healthy log, or more healthy "
            "motion"
        )
    return f"blind on {some(blind)}: a fault of {BLIND_SHARE:.0%} of the torque is not seen there; {cure}"
