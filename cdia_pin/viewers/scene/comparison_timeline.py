"""The timeline of a model compared with a log, as given and improved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.viewers.report_series import end_to_end
from cdia_pin.viewers.scene.timeline import SceneStage, Timeline, Track, frames
from cdia_pin.viewers.words import effect_words, joint_units, listed, number, percent, short_names, with_unit

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison, Discovery

Array = NDArray[np.float64]

COLOUR = "#d55e00"  # vermilion of Okabe and Ito
SEEN = 0.5  # [s], over which a residual is averaged for the eye
LEAST = 0.1  # [1], of a joint's torque: a residual below it is never shown in full colour


def timeline_of_comparison(
    before: Comparison, after: Comparison | None = None, discovery: Discovery | None = None
) -> Timeline:
    """Return the motion of the logs end to end, coloured by what the model misses, before and after effects are added.

    Args:
        before: The model as given.
        after: The improved model on the same logs; None if there is none.
        discovery: Names what was added.
    """
    time, _ = end_to_end(before)
    scale = before.torque_rms * max(LEAST, float(_largest(before, time).max()))
    compared = [("as given", before)]
    if after is not None:
        compared.append((_added(discovery), after))
    at = frames(time)
    tracks = tuple(_track(name, c, time, at, scale) for name, c in compared)
    full = float(np.max(scale / np.maximum(before.torque_rms, 1e-12)))
    whole = f"{percent(full)} of the joint's torque"
    stage = SceneStage("model error", COLOUR, f"full colour: {whole}", 0.0, 0.95, whole)
    return Timeline(time[at], before.signals["position"][at], (stage,), tracks)


def _largest(comparison: Comparison, time: Array) -> Array:
    """Return about the largest residual of each joint over its torque [1], shape (n,)."""
    size = np.percentile(_size(comparison, time), 98, axis=0)
    return np.asarray(size / np.maximum(comparison.torque_rms, 1e-12))


def _size(comparison: Comparison, time: Array) -> Array:
    """Return the moving RMS of the residual where it counts [N·m or N], shape (K, n)."""
    use = comparison.informative.astype(float)
    power = _mean(use * comparison.residual**2, time, SEEN)
    return np.sqrt(np.maximum(power, 0.0) / np.maximum(_mean(use, time, SEEN), 0.05))


def _mean(signal: Array, time: Array, window: float) -> Array:
    """Return the moving mean over a window [s]."""
    from scipy.ndimage import uniform_filter1d

    width = max(1, round(window / float(np.median(np.diff(time)))))
    return np.asarray(uniform_filter1d(signal, width, axis=0, mode="nearest"))


def _track(name: str, comparison: Comparison, time: Array, at: NDArray[np.intp], scale: Array) -> Track:
    level = (_size(comparison, time) / np.maximum(scale, 1e-12))[at]
    torque = _mean(comparison.residual, time, 0.2 * SEEN)[at]
    return Track(name, np.zeros(level.shape, int), level, torque, ((float(time[0]), _worst(comparison)),))


def _worst(comparison: Comparison) -> str:
    """Return what the model misses most: ``worst over the log: elbow, residual 2.1 N·m RMS, 35 % of its torque``."""
    robot = comparison.model.robot
    j = comparison.worst
    joint = robot.joints[j]
    size = with_unit(number(float(comparison.rms[j])), joint_units(robot, joint)["load"])
    share = percent(float(comparison.relative_rms[j]))
    return (
        f"worst over the log: {short_names(robot.joints)[joint]}, residual {size} RMS, {share} of its torque"
    )


def _added(discovery: Discovery | None) -> str:
    names = [effect_words(s.term.effect) for s in (discovery.steps if discovery else ()) if s.term]
    if not names:
        return "improved"
    return f"with {listed(names)}" if len(names) < 3 else f"with {len(names)} effects"
