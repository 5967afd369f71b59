"""The arm in a report: its shape, its motion, and its colours after each effect."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

import numpy as np

from cdia_pin.viewers.report_series import compact
from cdia_pin.viewers.scene import (
    Scene,
    SceneDocument,
    TimelineDocument,
    timeline_of_comparison,
    timeline_of_run,
)
from cdia_pin.viewers.verdict import mean_share
from cdia_pin.viewers.words import effect_words, percent, short_names

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.discovery import Comparison, Discovery, Step


class StepDocument(TypedDict):
    """An effect that was added, and the error of each joint with it."""

    name: str
    label: str
    level: list[float | None]


class MotionDocument(TypedDict):
    """The arm of a report and its motion."""

    arm: SceneDocument
    timeline: TimelineDocument
    steps: list[StepDocument]


def scene_of_run(run: MonitorRun) -> MotionDocument:
    """Return the arm of a run and its motion, coloured by the monitor's stages; ready for JSON.

    Args:
        run: The run.
    """
    return {"arm": Scene.of(run.robot).to_dict(), "timeline": timeline_of_run(run).to_dict(), "steps": []}


def scene_of_comparison(
    before: Comparison, after: Comparison | None = None, discovery: Discovery | None = None
) -> MotionDocument:
    """Return the arm of a comparison and the motion of its logs, coloured by the residual of the model.

    Args:
        before: The model as given against the logs.
        after: The improved model against them.
        discovery: How one became the other. Each step between has one colour per joint, by its RMS error:
            residuals over time are kept for the first and the last model only.
    """
    timeline = timeline_of_comparison(before, after, discovery).to_dict()
    steps = [] if discovery is None or after is None else _steps(discovery)
    return {"arm": Scene.of(before.model.robot).to_dict(), "timeline": timeline, "steps": steps}


def _steps(found: Discovery) -> list[StepDocument]:
    torque = np.maximum(found.torque_rms, 1e-12)
    most = max(float((found.trace[0].rms / torque).max()), 1e-12)
    return [
        {"name": _name(step), "label": _label(step, found), "level": compact(step.rms / torque / most)}
        for step in found.trace
    ]


def _name(step: Step) -> str:
    return "as given" if step.term is None else f"+ {effect_words(step.term.effect)}"


def _label(step: Step, found: Discovery) -> str:
    share = step.rms / np.maximum(found.torque_rms, 1e-12)
    worst = int(np.argmax(np.where(found.counted, share, -1.0)))
    joint = short_names(found.model.robot.joints)[found.model.robot.joints[worst]]
    mean = percent(mean_share(step.rms, found))
    return f"error {mean} of the torque, most on {joint}: {percent(float(share[worst]))}"
