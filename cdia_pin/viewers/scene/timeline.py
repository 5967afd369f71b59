"""`Timeline`: the motion of an arm and the state of its joints, no finer than an eye can follow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.log import Log
from cdia_pin.viewers.scene.attached import AttachedDocument, AttachedRows

Array = NDArray[np.float64]
Says = tuple[tuple[float, str], ...]

RATE = 30.0  # [Hz], frames that are kept
MOST = 2400  # frames; a longer motion has fewer a second


class StageDocument(TypedDict):
    """A stage as JSON has it; the keys are the attributes of `SceneStage`."""

    name: str
    colour: str
    words: str
    least: float
    most: float
    full: str


class TrackDocument(TypedDict):
    """A track as JSON has it; the keys are the attributes of `Track`."""

    name: str
    stage: list[list[int]]
    level: list[list[float]]
    torque: list[list[float]]
    label: list[tuple[float, str]]
    attached: list[tuple[float, AttachedDocument]]


class TimelineDocument(TrackDocument):
    """A timeline as JSON has it: its first track, with what all tracks share; ``variants`` are the other tracks."""

    time: list[float]
    position: list[list[float]]
    stages: list[StageDocument]
    desired: NotRequired[list[list[float]]]
    variants: NotRequired[list[TrackDocument]]


class Frame(TypedDict, total=False):
    """A piece of a timeline: rows of one frame, or of several."""

    time: list[float]
    position: list[list[float]]
    desired: list[list[float]]
    stage: list[list[int]]
    level: list[list[float]]
    torque: list[list[float]]
    label: list[tuple[float, str]]
    attached: list[tuple[float, AttachedDocument]]
    residual: list[list[float]]
    threshold: list[list[float]]


@dataclass(frozen=True)
class SceneStage:
    """A colour with its meaning.

    Attributes:
        name: Shown in legend and label.
        colour: As ``#rrggbb``.
        words: What it means.
        least: Share of the colour in a link's at level 0 [0, 1].
        most: Share at level 1 and above [0, 1].
        full: What level 1 stands for, with its unit, where the colour is a scale from 0; empty otherwise.
    """

    name: str
    colour: str
    words: str = ""
    least: float = 0.55
    most: float = 0.95
    full: str = ""

    def to_dict(self) -> StageDocument:
        """Return the stage as JSON has it."""
        return {
            "name": self.name,
            "colour": self.colour,
            "words": self.words,
            "least": self.least,
            "most": self.most,
            "full": self.full,
        }


@dataclass(frozen=True, eq=False)
class Track:
    """The state of the joints over the frames of a timeline, for one model.

    Attributes:
        name: Of the model; empty if there is only one.
        stage: Index in the timeline's stages, shape (K, n).
        level: Residual over its threshold or scale [1], shape (K, n).
        torque: Torque that the model lacks, 0 where it lacks none [N·m or N], shape (K, n).
        label: Texts, each shown from its time [s] on.
        attached: What acts on the whole arm, each from its time [s] on.
    """

    name: str
    stage: NDArray[np.integer]
    level: Array
    torque: Array
    label: Says = ()
    attached: AttachedRows = ()

    def to_dict(self) -> TrackDocument:
        """Return the track as JSON has it."""
        return {
            "name": self.name,
            "stage": self.stage.astype(int).tolist(),
            "level": np.round(self.level, 2).tolist(),
            "torque": np.round(self.torque, 3).tolist(),
            "label": [(round(t, 3), text) for t, text in self.label],
            "attached": list(self.attached),
        }


@dataclass(frozen=True, eq=False)
class Timeline:
    """A motion of K frames, and one or more tracks over it.

    Attributes:
        time: Time [s], shape (K,).
        position: Where the arm is [rad or m], shape (K, n).
        stages: What the numbers of the tracks' stages mean; later is graver.
        tracks: The first is shown until another is chosen.
        desired: Where it should be [rad or m], shape (K, n); None where nobody says.
    """

    time: Array
    position: Array
    stages: tuple[SceneStage, ...]
    tracks: tuple[Track, ...]
    desired: Array | None = None

    def to_dict(self) -> TimelineDocument:
        """Return the timeline as the browser takes it: numbers rounded to what can be seen."""
        shown, *others = (t.to_dict() for t in self.tracks)
        out: TimelineDocument = {
            "time": np.round(self.time, 3).tolist(),
            "position": np.round(self.position, 5).tolist(),
            "stages": [s.to_dict() for s in self.stages],
            "name": shown["name"],
            "stage": shown["stage"],
            "level": shown["level"],
            "torque": shown["torque"],
            "label": shown["label"],
            "attached": shown["attached"],
        }
        if self.desired is not None:
            out["desired"] = np.round(self.desired, 5).tolist()
        if others:
            out["variants"] = others
        return out


def timeline_of_log(log: Log) -> Timeline:
    """Return the motion of a log alone.

    Args:
        log: The log.
    """
    at = frames(log.time)
    nothing = np.zeros((len(at), len(log.joints)))
    return Timeline(log.time[at], log.position[at], (), (Track("", nothing.astype(int), nothing, nothing),))


def frames(time: Array, keep: Sequence[float] = (), rate: float = RATE) -> NDArray[np.intp]:
    """Return the indices of the samples that become frames.

    Args:
        time: Increasing [s], shape (K,).
        keep: Times [s]; the first sample at or after each becomes a frame too.
        rate: Most frames per second [Hz].
    """
    rate = min(rate, MOST / max(float(time[-1] - time[0]), 1e-9))
    wanted = np.arange(time[0], time[-1], 1.0 / rate)
    at = np.searchsorted(time, np.concatenate([wanted, np.asarray(keep, float)]) - 1e-9)
    return np.unique(np.append(np.minimum(at, len(time) - 1), len(time) - 1))
