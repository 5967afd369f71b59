"""Frames of a picture, made from the ticks of a monitor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.record import STAGES
from cdia_pin.viewers.scene.attached import NOTHING, AttachedWords
from cdia_pin.viewers.scene.run_timeline import event_label, levels, missing_torque
from cdia_pin.viewers.scene.timeline import RATE, Frame

if TYPE_CHECKING:
    from cdia_pin.diagnosis import Status
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class FrameMaker:
    """Makes frames of ticks: at most `rate` a second, and one of every tick with an event.

    Args:
        robot: The arm.
        in_torque: Whether residuals are torques; otherwise the missing torque is taken from the correction.
        rate: Frames per second [Hz].
    """

    def __init__(self, robot: RobotModel, *, in_torque: bool = True, rate: float = RATE) -> None:
        self._robot, self._in_torque, self._period = robot, in_torque, 1.0 / rate
        self._next = -np.inf
        self._document_of, self._attached = AttachedWords(robot), NOTHING

    def __call__(
        self, time: float, q: Array, status: Status | None = None, desired: Array | None = None
    ) -> Frame | None:
        """Return the frame of a tick as a piece of a timeline, None where none is due.

        Args:
            time: Time [s].
            q: Positions [rad or m], shape (n,).
            status: Status of the monitor; None without a monitor.
            desired: Desired positions [rad or m], shape (n,); None where they are not known.
        """
        events = status.events if status else ()
        if time < self._next and not events:
            return None
        self._next = max(self._next + self._period, time + 0.5 * self._period)
        frame: Frame = {"time": [round(time, 3)], "position": [np.round(q, 5).tolist()]}
        if desired is not None:
            frame["desired"] = [np.round(desired, 5).tolist()]
        if status is None:
            return frame
        stage = np.array([STAGES.index(s) for s in status.stages])
        missing = status.residual if self._in_torque else -status.torque_correction
        frame["stage"] = [stage.tolist()]
        frame["level"] = [np.round(levels(status.residual, status.threshold), 2).tolist()]
        frame["torque"] = [np.round(missing_torque(stage, missing), 3).tolist()]
        attached = self._document_of(status.faults)
        if attached != self._attached:
            frame["attached"], self._attached = [(round(time, 3), attached)], attached
        if events:
            frame["label"] = [(round(e.time, 3), event_label(e, self._robot)) for e in events]
        return frame
