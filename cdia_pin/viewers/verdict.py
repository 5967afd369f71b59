"""What a discovery means, in sentences shared by the terminal and the pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.changes.confidence import Confidence
from cdia_pin.regression import shares
from cdia_pin.viewers.effect_groups import (
    MOST_RIVALS,
    effect_groups,
    on_joints,
    rivals,
    term_of,
    these_joints,
)
from cdia_pin.viewers.words import (
    NOTICEABLE,
    advice_words,
    confusion_words,
    course_words,
    effect_words,
    few,
    listed,
    percent,
    sentence_case,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison, Discovery, Step

NAMES = {
    Confidence.ESTABLISHED: "established",
    Confidence.LIKELY: "likely",
    Confidence.DESCRIPTIVE: "only descriptive: it may be something else",
}
NAMED = 3  # groups of effects that a sentence names before it counts the others


def verdict_sentences(found: Discovery) -> list[str]:
    """Return what a discovery means, in sentences, the verdict first.

    Args:
        found: The outcome of ``discover``.

    Returns:
        Sentences for the head of a report or the end of a terminal's output.
    """
    robot = found.model.robot.name
    log = "the logs" if len(found.record.get("logs", ())) > 1 else "the log"
    if found.verdict == "nothing-missing":
        said = [f"Nothing is missing: the model of {robot} explains {log} down to the noise."]
    elif found.verdict == "explained" and not error_falls(found):
        said = [f"The model of {robot} explains {log} down to the noise without {_what(found)[0]} too."]
    elif found.verdict == "explained":
        said = [f"The model of {robot} explains {log} down to the noise once {' '.join(_what(found))} added."]
    elif found.verdict == "explained-in-practice":
        said = [_practice_sentence(found, log)]
    else:
        said = _structure_sentences(found)
    recognised = [f"{sentence_case(f.sentence)}." for f in found.findings]
    return [
        *said,
        *_tail_sentences(found),
        *recognised,
        *_rest_sentences(found),
        _error_sentence(found),
        *_confusion_sentences([s for s in found.steps if s.confidence is not Confidence.DESCRIPTIVE]),
    ]


def _rest_sentences(found: Discovery) -> list[str]:
    """Return which joints at rest something else than their motor holds, and which show a part of their load only."""
    out = []
    if found.held:
        are, them, they = ("is", "it", "it does") if len(found.held) == 1 else ("are", "them", "they do")
        out.append(
            f"{listed(found.held)} {are} at rest, and the torque does not tell the load: "
            f"a brake or friction holds {them}, and {they} not count."
        )
    if found.resting and found.steps:
        are, their = ("is", "its") if len(found.resting) == 1 else ("are", "their")
        out.append(
            f"{listed(found.resting)} {are} at rest, or too slow for {their} encoder, and static friction carries "
            f"a part of {their} load: {rest_words(found)}."
        )
    return out


def rest_words(found: Discovery) -> str:
    """Return what joints at rest are good for: next to nothing beside joints that move.

    Args:
        found: The outcome of ``discover``, with joints at rest.
    """
    if found.counted.all():  # none moves
        return "what they show is likely at most"
    return "what only joints at rest show is descriptive, and their error is in no mean"


def addition_sentences(found: Discovery) -> list[str]:
    """Return what adding one effect has done: the error before and after, how sure its name is, and its rivals.

    Args:
        found: The outcome of ``add_effect``.
    """
    (step,) = found.steps
    before, after = (unseen_share(s.heldout_rms, found) for s in found.trace)
    name = sentence_case(effect_words(term_of(step).effect))
    if not error_falls(found):
        return [
            f"{name} does not lower the error on data that was not fitted: {percent(before)} of the torque."
        ]
    return [
        f"{name} lowers the error on data that was not fitted from {percent(before)} to {percent(after)} of the "
        f"measured torque (mean over the joints); its name is {NAMES[step.confidence]}.",
        *_confusion_sentences(found.steps),
    ]


def comparison_sentence(found: Comparison) -> str:
    """Return how far a model is from its logs, and on which joint most.

    Args:
        found: The outcome of ``compare``.
    """
    worst, joints = found.worst, found.model.robot.joints
    return (
        f"The model of {found.model.robot.name} differs from the measured torque by {percent(found.mean_error)} "
        f"(mean over the joints), most on {joints[worst]} ({percent(float(found.relative_rms[worst]))})."
    )


def mean_share(errors: Sequence[float] | np.ndarray, found: Discovery) -> float:
    """Return error over torque RMS, mean over the joints that move [1].

    Args:
        errors: RMS of each joint [N·m or N], shape (n,).
        found: The outcome of ``discover``.
    """
    return shares.mean_share(errors, found.torque_rms, found.counted)


def unseen_share(errors: Sequence[float] | np.ndarray, found: Discovery) -> float:
    """Return error over torque RMS on data that was not fitted, mean over the joints that move [1].

    Args:
        errors: Held-out RMS of each joint [N·m or N], shape (n,).
        found: The outcome of ``discover``.
    """
    return shares.mean_share(errors, found.heldout_torque_rms, found.counted)


def error_falls(found: Discovery) -> bool:
    """Tell whether what was added lowers the error on data that was not fitted.

    Args:
        found: The outcome of ``discover`` or ``add_effect``.
    """
    first, last = found.trace[0], found.trace[-1]
    return unseen_share(last.heldout_rms, found) < NOTICEABLE * unseen_share(first.heldout_rms, found)


def error_left(found: Discovery) -> dict[str, float]:
    """Return the error on data that was not fitted over the torque [1], of each joint on which structure is left.

    Args:
        found: The outcome of ``discover``.
    """
    robot = found.model.robot
    share = found.trace[-1].heldout_rms / np.maximum(found.heldout_torque_rms, 1e-12)
    return {j: float(share[robot.joint_index(j)]) for j in found.structure_left}


def _what(found: Discovery) -> tuple[str, str]:
    """Return the effects that a sentence names, and their verb: established and likely ones, or else all."""
    groups, joints = effect_groups(found), found.model.robot.joints
    marks = {Confidence.ESTABLISHED: "", Confidence.LIKELY: " (likely)"}
    said = [g.words(joints) + marks[g.confidence] for g in groups if g.confidence in marks]
    if not said:
        said = [f"{g.words(joints)} (perhaps)" for g in groups]
    said = said if len(said) <= NAMED + 1 else [*said[:NAMED], f"{len(said) - NAMED} more"]
    return listed(said), "is" if len(said) == 1 else "are"


def _tail_sentences(found: Discovery) -> list[str]:
    """Return what only describes, beside something that is surer."""
    groups, joints = effect_groups(found), found.model.robot.joints
    tail = [g.words(joints) for g in groups if g.confidence is Confidence.DESCRIPTIVE]
    if not tail or len(tail) == len(groups):
        return []
    return [f"Added to describe the rest, and perhaps something else: {listed(tail)}."]


def _practice_sentence(found: Discovery, log: str) -> str:
    robot, left = found.model.robot, error_left(found)
    said = f"The model of {robot.name} explains {log} in practice"
    said += f" once {' '.join(_what(found))} added" if found.steps else ""
    most = percent(max(left.values(), default=0.0))
    where = on_joints(found.structure_left, robot.joints)
    return f"{said}: what is left{where} has structure, but is small, at most {most} of a joint's torque."


def _structure_sentences(found: Discovery) -> list[str]:
    left, joints = found.structure_left, found.model.robot.joints
    few, every = len(left) < NAMED, len(left) == len(joints)
    counted = these_joints(joints, joints) if every else f"{len(left)} of the {len(joints)} joints"
    where = listed(left) if few else counted
    rest = f"the residual on {where} has structure that no effect explains."
    if found.steps:
        said = [f"The model of {found.model.robot.name} lacks {_what(found)[0]}; {rest}"]
    else:
        said = [f"{rest[0].upper()}{rest[1:]}"]
    return said if few or every else [*said, f"The residual still follows the motion on {listed(left)}."]


def _error_sentence(found: Discovery) -> str:
    first, last = found.trace[0], found.trace[-1]
    floor = f"the noise floor is {percent(mean_share(found.noise_floor, found))}"
    before, after = mean_share(first.rms, found), mean_share(last.rms, found)
    if len(found.trace) == 1:
        return f"The error is {percent(before)} of the measured torque (mean over the joints), {floor}."
    unseen = unseen_share(last.heldout_rms, found)
    unseen_course = f"is {percent(unseen)}"
    if not error_falls(found):
        unseen_course = course_words(unseen_share(first.heldout_rms, found), unseen)
    return (
        f"The error {course_words(before, after)} of the measured torque (mean over the joints); "
        f"on data that was not fitted it {unseen_course}, {floor}."
    )


def _confusion_sentences(steps: Sequence[Step]) -> list[str]:
    doubtful = [s for s in steps if s.term and s.confusions]
    if not doubtful:
        return []
    if len(doubtful) > 1:
        some = f"{len(doubtful)} of the" if len(doubtful) < len(steps) else "All"
        return [
            f"{some} {len(steps)} effects could be mistaken for others with this motion; "
            "the motions that would distinguish them are listed."
        ]
    step = doubtful[0]
    effect = term_of(step).effect
    others = rivals(effect, step.confusions)
    said = listed(few((confusion_words(c) for c in others), MOST_RIVALS))
    advice = advice_words(others[0].motion)
    return [f"With this motion, {effect_words(effect)} is hard to distinguish from {said}; {advice}."]
