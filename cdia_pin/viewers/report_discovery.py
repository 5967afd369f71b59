"""The part of a report that a discovery adds: verdict, effects, the error step by step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from cdia_pin.viewers.report_series import Numbers, compact, compact_one
from cdia_pin.viewers.verdict import mean_share, verdict_sentences
from cdia_pin.viewers.words import (
    advice_words,
    confusion_words,
    effect_name,
    effect_words,
    joint_units,
    number,
    parameter_name,
    profile_words,
    where_words,
    with_interval,
    with_unit,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Step
    from cdia_pin.effects import Term
    from cdia_pin.robot.model import RobotModel


class ParameterRow(TypedDict):
    """A parameter in words; ``telling``: its interval leaves out zero."""

    name: str
    text: str
    interval: Numbers | None
    telling: bool


class ShapeRow(TypedDict):
    """A shape parameter in words."""

    name: str
    text: str


class LargestFall(TypedDict):
    """The joint on which an effect lowers the error most; errors over its torque [1]."""

    joint: str
    before: float | None
    after: float | None


class ConfusionRow(TypedDict):
    """Another explanation, and the motion that would distinguish it."""

    words: str
    motion: str


class EffectDocument(TypedDict):
    """An effect that was found."""

    number: int
    name: str
    joints: list[str]
    where: str
    equation: str
    parameters: list[ParameterRow]
    shape: list[ShapeRow]
    profile: str
    error: LargestFall
    confusions: list[ConfusionRow]


class TraceRow(TypedDict):
    """Errors after a step, as shares of the torque RMS [1]."""

    added: str
    share: Numbers
    heldout: Numbers
    mean: float | None
    heldout_mean: float | None


class DiscoveryDocument(TypedDict):
    """What a report shows of a discovery."""

    verdict: str
    sentences: list[str]
    structure_left: list[str]
    effects: list[EffectDocument]
    trace: list[TraceRow]
    floor: Numbers
    floor_mean: float | None
    settings: dict[str, Any]  # as the record has them


def discovery_data(found: Discovery) -> DiscoveryDocument:
    """Return verdict, effects and errors step by step, ready for JSON.

    Args:
        found: The outcome of ``discover``.
    """
    torque = np.maximum(found.torque_rms, 1e-12)
    return {
        "verdict": found.verdict,
        "sentences": verdict_sentences(found),
        "structure_left": list(found.structure_left),
        "effects": [_effect(k, found) for k in range(1, len(found.trace))],
        "trace": [
            {
                "added": effect_words(s.term.effect) if s.term else "model as given",
                "share": compact(s.rms / torque),
                "heldout": compact(s.heldout_rms / torque),
                "mean": compact_one(mean_share(s.rms, found)),
                "heldout_mean": compact_one(mean_share(s.heldout_rms, found)),
            }
            for s in found.trace
        ],
        "floor": compact(found.noise_floor / torque),
        "floor_mean": compact_one(mean_share(found.noise_floor, found)),
        "settings": {k: v for k, v in found.record.items() if k not in {"logs", "holdout", "version"}},
    }


def _effect(k: int, found: Discovery) -> EffectDocument:
    step, robot = found.trace[k], found.model.robot
    term = step.term
    assert term is not None  # only the first step of a trace is without
    return {
        "number": k,
        "name": effect_name(term.effect),
        "joints": list(term.effect.scope),
        "where": where_words(term.effect),
        "equation": term.effect.equation,
        "parameters": parameters(term, robot),
        "shape": shape_parameters(term, robot),
        "profile": profile_words(term),
        "error": _largest_fall(found.trace[k - 1], step, found),
        "confusions": [
            {"words": confusion_words(c), "motion": advice_words(c.motion)} for c in step.confusions
        ],
    }


def parameters(term: Term, robot: RobotModel) -> list[ParameterRow]:
    """Return the parameters of a term in words, with their intervals.

    Args:
        term: An effect with numbers.
        robot: The arm, for the units.
    """
    intervals = term.ci95 or (None,) * len(term.theta)
    rows = zip(term.effect.parameters, term.theta, term.effect.units(robot), intervals, strict=True)
    return [
        {
            "name": parameter_name(p.name),
            "text": with_interval(value, interval, unit),
            "interval": None if interval is None else compact([interval[0], value, interval[1]]),
            "telling": interval is None or not bool(interval[0] <= 0.0 <= interval[1]),
        }
        for p, value, unit, interval in rows
    ]


def shape_parameters(term: Term, robot: RobotModel) -> list[ShapeRow]:
    """Return the shape parameters of a term in words.

    Args:
        term: An effect with numbers.
        robot: The arm, for the units.
    """
    effect = term.effect
    units = joint_units(robot, effect.scope[0] if effect.scope else robot.joints[0])
    words = {"{position}": units["position"], "{effort}": units["load"]}
    out: list[ShapeRow] = []
    for p in effect.shape:
        unit = p.unit
        for word, meant in words.items():
            unit = unit.replace(word, meant)
        out.append({"name": p.name, "text": with_unit(number(effect.shape_values[p.name]), unit)})
    return out


def _largest_fall(before: Step, after: Step, found: Discovery) -> LargestFall:
    """Return the joint on which a step lowered the error most, and the error there over its torque."""
    torque = np.maximum(found.torque_rms, 1e-12)
    j = int(np.argmax((before.rms - after.rms) / torque))
    return {
        "joint": found.model.robot.joints[j],
        "before": compact_one(before.rms[j] / torque[j]),
        "after": compact_one(after.rms[j] / torque[j]),
    }
