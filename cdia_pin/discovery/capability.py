"""Capability: what a model is good for, as the smallest change of the arm that it lets a user notice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.discovery_documents import ByJoint
from cdia_pin.effects import Payload
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.discovery_settings import ChangeSettings

Array = NDArray[np.float64]


class CapabilityJson(TypedDict):
    """A capability in JSON.

    Attributes:
        payload: Smallest payload [kg]; None if the motion shows none.
        push: Smallest steady push at the tool in any direction [N]; None if the motion shows none.
        friction: Smallest growth of friction by joint [N·m or N].
        feedforward_error: Error of the torque on data that was not fitted, by joint, over the torque [1].
    """

    payload: float | None
    push: float | None
    friction: ByJoint
    feedforward_error: ByJoint


DIRECTIONS = 500  # [1], of a push that are tried: they are 0.1 rad apart
GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))  # [rad], between neighbours that never lie above each other
LEAST_SHOWN = 1e-18  # [1/N²], below which a push does not show: no joint has a torque from it


@dataclass(frozen=True, repr=False)
class Capability:
    """What a model lets a user notice on motions such as the log's.

    A change is noticed where its RMS torque stands out from what the model leaves: with the shares of `ChangeSettings`,
    a third of the error, and three percent of the torque. A joint at rest shows nothing for certain, because static
    friction carries a part of its load.

    Attributes:
        payload: Smallest payload at the tool [kg]; infinite if the motion shows none.
        push: Smallest steady push at the tool, whatever its direction [N]; infinite if the motion shows none.
        friction: Smallest growth of friction of each joint [N·m or N], infinite where it rests or no sample counts,
            shape (n,).
        feedforward_error: Error of the torque on data that was not fitted, over the torque [1], shape (n,).
    """

    payload: float
    push: float
    friction: Array
    feedforward_error: Array

    def __repr__(self) -> str:
        return f"Capability(payload {self.payload:.2g} kg, push {self.push:.2g} N)"

    def to_dict(self, robot: RobotModel) -> CapabilityJson:
        """Return the capability for JSON.

        Args:
            robot: The arm, for the names of its joints.
        """
        return {
            "payload": self.payload if np.isfinite(self.payload) else None,
            "push": self.push if np.isfinite(self.push) else None,
            "friction": {j: f for j, f in robot.by_joint(self.friction).items() if np.isfinite(f)},
            "feedforward_error": robot.by_joint(self.feedforward_error),
        }


def capability_of(
    experiment: Experiment, error: Array, torque: Array, settings: ChangeSettings
) -> Capability:
    """Return what a model lets a user notice.

    Args:
        experiment: The logs.
        error: RMS error of the model on data that was not fitted [N·m or N], shape (n,).
        torque: RMS of the torque measured there [N·m or N], shape (n,).
        settings: What a change must explain.
    """
    ratio = np.sqrt(settings.least_share / (1 - settings.least_share))
    noticed = np.maximum(ratio * error, settings.least_torque * torque)
    noticed[(noticed == 0) | ~experiment.joints_that_move] = np.inf  # no sample counts, or it rests
    states = [s.state for s in experiment.segments]
    body = np.vstack([Payload().basis(x)[:, :, 0] for x in states])
    jacobian = np.vstack([np.asarray(experiment.robot.tool_jacobian(x.q))[:, :3, :] for x in states])
    return Capability(
        payload=_smallest(noticed, body),
        push=_smallest_push(noticed, jacobian),
        friction=noticed,
        feedforward_error=error / np.maximum(torque, 1e-12),
    )


def _smallest(noticed: Array, of_unit: Array) -> float:
    """Return the smallest size that some joint notices, of a cause with a torque per unit, shape (K, n)."""
    size = rms(of_unit, np.ones_like(of_unit, bool))
    return float(np.min(np.where(size > 1e-9, noticed / np.maximum(size, 1e-9), np.inf)))


def _smallest_push(noticed: Array, jacobian: Array) -> float:
    """Return the smallest push that some joint notices in the direction in which it shows least [N].

    Args:
        noticed: RMS torque that each joint notices [N·m or N], shape (n,).
        jacobian: Torque of each joint per newton at the tool along each axis [m or 1], shape (K, 3, n).
    """
    squares = np.einsum("kaj,kbj->jab", jacobian, jacobian) / len(jacobian)
    along = _directions()
    shown = np.einsum("da,jab,db->dj", along, squares, along) / noticed**2
    least = float(shown.max(axis=1).min())
    return least**-0.5 if least > LEAST_SHOWN else np.inf


def _directions() -> Array:
    """Return unit vectors that are spread evenly over half a sphere, shape (DIRECTIONS, 3)."""
    up = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    around = np.arange(DIRECTIONS) * GOLDEN_ANGLE
    across = np.sqrt(1 - up**2)
    return np.column_stack([across * np.cos(around), across * np.sin(around), up])
