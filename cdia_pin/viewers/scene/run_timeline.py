"""The timeline of a monitor's run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import Event, Stage
from cdia_pin.viewers.event_words import fault_words
from cdia_pin.viewers.scene.timeline import SceneStage, Timeline, Track, frames
from cdia_pin.viewers.stage_colours import STAGE_COLOURS, STAGE_WORDS
from cdia_pin.viewers.words import effect_name, listed, short_names

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# A healthy link stays near its own colour; one that needs attention is told from afar.
SHARES = {Stage.HEALTHY: (0.0, 0.22), Stage.IDLE: (0.3, 0.6), Stage.SUSPECT: (0.5, 0.95)}
CALM = (Stage.HEALTHY, Stage.IDLE)  # what is missing there is noise


def monitor_stages() -> tuple[SceneStage, ...]:
    """Return the colours of a monitor's stages, in the order of its numbers."""
    return tuple(
        SceneStage(str(s), STAGE_COLOURS[s], STAGE_WORDS[s], *SHARES.get(s, (0.65, 0.95))) for s in STAGES
    )


def timeline_of_run(run: MonitorRun) -> Timeline:
    """Return the motion of a run, coloured by the monitor's stages; residual over threshold is the intensity."""
    at = frames(run.time, [e.time for e in run.events])
    stage = run.stages[at]
    missing = run.residual[at] if run.in_torque else -run.torque_correction[at]
    track = Track(
        name="",
        stage=stage,
        level=levels(run.residual[at], run.threshold[at]),
        torque=missing_torque(stage, missing),
        label=spoken(run.events, run.robot),
    )
    desired = None if run.desired is None else run.desired[at]
    return Timeline(run.time[at], run.position[at], monitor_stages(), (track,), desired)


def levels(residual: Array, threshold: Array) -> Array:
    """Return residual over threshold [1], in the shape of both."""
    return np.abs(residual) / np.maximum(threshold, 1e-12)


def missing_torque(stage: NDArray[np.integer], torque: Array) -> Array:
    """Return what is missing at joints that are not calm, and 0 at those that are [N·m or N]."""
    calm = np.isin(stage, [STAGES.index(s) for s in CALM])
    return np.where(calm, 0.0, torque)


def spoken(events: Sequence[Event], robot: RobotModel) -> tuple[tuple[float, str], ...]:
    """Return what a label says after each event that changes it."""
    said: list[tuple[float, str]] = []
    for event in events:
        label = event_label(event, robot)
        if not said or said[-1][1] != label:
            said.append((event.time, label))
    return tuple(said)


def event_label(event: Event, robot: RobotModel) -> str:
    """Return an event in a line, such as ``coulomb friction on elbow_joint: level 4.99 ± 0.01 N·m``."""
    short = short_names(robot.joints)
    where = "all joints" if len(event.joints) == robot.n > 1 else listed(short[j] for j in event.joints)
    if event.stage == "detection":
        return f"{where}: a fault, which one is being decided"
    if event.stage == "idle":
        return f"{where}: the fault is gone, and remembered"
    if not event.faults:
        return f"{where}: no known effect"
    said = "; ".join(fault_words(t, robot, joint=True) for t in event.faults)
    others = " or ".join(" with ".join(effect_name(t.effect) for t in one) for one in event.alternatives)
    return said + (f" (or {others})" if others else "")
