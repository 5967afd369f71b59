"""The timeline of a monitor's run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import Event, Stage
from cdia_pin.effects import ExternalWrench
from cdia_pin.viewers.event_words import fault_words
from cdia_pin.viewers.scene.attached import attached_rows
from cdia_pin.viewers.scene.timeline import SceneStage, Timeline, Track, frames
from cdia_pin.viewers.stage_colours import STAGE_COLOURS, STAGE_WORDS
from cdia_pin.viewers.whole_arm_row import of_whole_arm
from cdia_pin.viewers.words import effect_name, listed, short_names

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# A healthy link keeps nearly its own colour; one that needs attention is seen from afar.
SHARES = {Stage.HEALTHY: (0.0, 0.22), Stage.IDLE: (0.3, 0.6), Stage.SUSPECT: (0.5, 0.95)}
CALM = (Stage.HEALTHY, Stage.IDLE)  # the residual there is noise


def monitor_stages() -> tuple[SceneStage, ...]:
    """Return the colours of a monitor's stages, in the order of its numbers."""
    return tuple(
        SceneStage(str(s), STAGE_COLOURS[s], STAGE_WORDS[s], *SHARES.get(s, (0.65, 0.95))) for s in STAGES
    )


def timeline_of_run(run: MonitorRun) -> Timeline:
    """Return the motion of a run, coloured by the monitor's stages; residual over threshold is the intensity.

    Args:
        run: The run.
    """
    at = frames(run.time, [e.time for e in run.events])
    stage = run.stages[at]
    missing = run.residual[at] if run.in_torque else -run.torque_correction[at]
    track = Track(
        name="",
        stage=stage,
        level=levels(run.residual[at], run.threshold[at]),
        torque=missing_torque(stage, missing),
        label=spoken(run.events, run.robot),
        attached=attached_rows([(b.time, b.faults) for b in run.beliefs], run.robot),
    )
    desired = None if run.desired is None else run.desired[at]
    return Timeline(run.time[at], run.position[at], monitor_stages(), (track,), desired)


def levels(residual: Array, threshold: Array) -> Array:
    """Return residual over threshold [1], in the shape of both.

    Args:
        residual: [N·m or N].
        threshold: [N·m or N].
    """
    return np.abs(residual) / np.maximum(threshold, 1e-12)


def missing_torque(stage: NDArray[np.integer], torque: Array) -> Array:
    """Return the torque that the model lacks [N·m or N]: 0 at healthy joints and where the fault is cleared.

    Args:
        stage: Indices in `STAGES`, shape (..., n).
        torque: Of the same shape [N·m or N].
    """
    calm = np.isin(stage, [STAGES.index(s) for s in CALM])
    return np.where(calm, 0.0, torque)


def spoken(events: Sequence[Event], robot: RobotModel) -> tuple[tuple[float, str], ...]:
    """Return the label after each event that changes it, with its time [s].

    Args:
        events: In their order.
        robot: The arm.
    """
    said: list[tuple[float, str]] = []
    for event in events:
        label = event_label(event, robot)
        if not said or said[-1][1] != label:
            said.append((event.time, label))
    return tuple(said)


def event_label(event: Event, robot: RobotModel) -> str:
    """Return an event in a line, such as ``coulomb friction on elbow_joint: level 4.99 ± 0.01 N·m``.

    Args:
        event: The event.
        robot: The arm.
    """
    short = short_names(robot.joints)
    where = "all joints" if len(event.joints) == robot.n > 1 else listed(short[j] for j in event.joints)
    if event.stage == "detection":
        return f"{where}: fault not isolated yet"
    if event.stage == "idle":
        cleared = "fault cleared, kept in memory"
        return f"{where}: {event.reason if of_whole_arm(event.faults) else cleared}"
    if not event.faults:
        return f"{where}: no known effect"
    if isinstance(event.faults[0].effect, ExternalWrench):
        return f"contact on the link of {short[event.faults[0].effect.scope[0]]}"
    said = "; ".join(fault_words(t, robot, joint=True) for t in event.faults)
    others = " or ".join(" with ".join(effect_name(t.effect) for t in one) for one in event.alternatives)
    return said + (f" (or {others})" if others else "")
