"""The part of a report that a discovery adds: verdict, effects, the error step by step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from cdia_pin.viewers.effect_groups import effect_groups, rivals, term_of
from cdia_pin.viewers.parameter_rows import (
    ParameterRow,
    ShapeRow,
    group_numbers,
    shape_parameters,
    step_parameters,
)
from cdia_pin.viewers.report_series import Numbers, compact, compact_one
from cdia_pin.viewers.short_answer import noticed, short_answer
from cdia_pin.viewers.verdict import mean_share, unseen_share, verdict_sentences
from cdia_pin.viewers.words import (
    advice_words,
    confusion_words,
    effect_name,
    effect_words,
    joint_units,
    listed,
    number,
    profile_words,
    where_words,
    with_unit,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Step


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
    """An effect that was found; ``changed``: the model as given has it too, the numbers are differences."""

    number: int
    confidence: str
    changed: bool
    name: str
    joints: list[str]
    where: str
    equation: str
    parameters: list[ParameterRow]
    shape: list[ShapeRow]
    profile: str
    error: LargestFall
    confusions: list[ConfusionRow]


class GroupDocument(TypedDict):
    """Effects of one kind that are trusted alike; ``members`` are their numbers."""

    confidence: str
    words: str
    numbers: str
    members: list[int]


class CapabilityDocument(TypedDict):
    """What the improved model lets a user notice, in words; ``friction`` by joint, ``error`` as shares [1]."""

    noticed: str
    friction: list[str]
    error: Numbers


class AnswerLine(TypedDict):
    """A line of the short answer."""

    head: str
    text: str


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
    answer: list[AnswerLine]
    sentences: list[str]
    structure_left: list[str]
    groups: list[GroupDocument]
    effects: list[EffectDocument]
    capability: CapabilityDocument
    trace: list[TraceRow]
    floor: Numbers
    floor_mean: float | None
    settings: dict[str, Any]  # as the record has them


def discovery_data(found: Discovery) -> DiscoveryDocument:
    """Return verdict, effects and errors step by step, ready for JSON.

    Args:
        found: The outcome of ``discover``.
    """
    torque, unseen = (np.maximum(x, 1e-12) for x in (found.torque_rms, found.heldout_torque_rms))
    return {
        "verdict": found.verdict,
        "answer": [{"head": head, "text": text} for head, text in short_answer(found)],
        "sentences": verdict_sentences(found),
        "structure_left": list(found.structure_left),
        "groups": _groups(found),
        "effects": [_effect(k, found) for k in range(1, len(found.trace))],
        "capability": _capability(found),
        "trace": [
            {
                "added": effect_words(s.term.effect) if s.term else "model as given",
                "share": compact(s.rms / torque),
                "heldout": compact(s.heldout_rms / unseen),
                "mean": compact_one(mean_share(s.rms, found)),
                "heldout_mean": compact_one(unseen_share(s.heldout_rms, found)),
            }
            for s in found.trace
        ],
        "floor": compact(found.noise_floor / torque),
        "floor_mean": compact_one(mean_share(found.noise_floor, found)),
        "settings": {k: v for k, v in found.record.items() if k not in {"logs", "holdout", "version"}},
    }


def _groups(found: Discovery) -> list[GroupDocument]:
    robot, at = found.model.robot, {id(s): k for k, s in enumerate(found.trace)}
    return [
        {
            "confidence": str(g.confidence),
            "words": g.words(robot.joints),
            "numbers": group_numbers(g, robot),
            "members": [at[id(s)] for s in g.steps],
        }
        for g in effect_groups(found)
    ]


def _capability(found: Discovery) -> CapabilityDocument:
    able, robot = found.capability, found.model.robot
    units = [joint_units(robot, j)["load"] for j in robot.joints]
    return {
        "noticed": listed(noticed(found)),
        "friction": [
            with_unit(number(f, 2), u) if np.isfinite(f) else "–"
            for f, u in zip(able.friction, units, strict=True)
        ],
        "error": compact(able.feedforward_error),
    }


def _effect(k: int, found: Discovery) -> EffectDocument:
    step, robot = found.trace[k], found.model.robot
    term = term_of(step)
    return {
        "number": k,
        "confidence": str(step.confidence),
        "changed": step.change_of_model,
        "name": effect_name(term.effect),
        "joints": list(term.effect.scope),
        "where": where_words(term.effect),
        "equation": term.effect.equation,
        "parameters": step_parameters(step, robot),
        "shape": shape_parameters(term, robot),
        "profile": profile_words(term),
        "error": _largest_fall(found.trace[k - 1], step, found),
        "confusions": [
            {"words": confusion_words(c), "motion": advice_words(c.motion)}
            for c in rivals(term.effect, step.confusions)
        ],
    }


def _largest_fall(before: Step, after: Step, found: Discovery) -> LargestFall:
    """Return the joint on which a step lowered the error most, and the error there over its torque."""
    torque = np.maximum(found.torque_rms, 1e-12)
    j = int(np.argmax((before.rms - after.rms) / torque))
    return {
        "joint": found.model.robot.joints[j],
        "before": compact_one(before.rms[j] / torque[j]),
        "after": compact_one(after.rms[j] / torque[j]),
    }
