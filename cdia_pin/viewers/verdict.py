"""What a discovery means, in sentences shared by the terminal and the pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.viewers.words import advice_words, confusion_words, effect_words, few, listed, percent

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison, Discovery, Step

NOTICEABLE = 0.99  # [1], of the error, above which it has not fallen
NAMED = 3  # effects that a sentence names before it counts the others


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
        said = [f"The model of {robot} explains {log} down to the noise without {_what(found.steps)} too."]
    elif found.verdict == "explained":
        added = "is added" if len(found.steps) == 1 else "are added"
        said = [f"The model of {robot} explains {log} down to the noise once {_what(found.steps)} {added}."]
    else:
        said = _structure_sentences(found)
    recognised = [f"{f.sentence[:1].upper()}{f.sentence[1:]}." for f in found.findings]
    return [*said, *recognised, _error_sentence(found), *_confusion_sentences(found.steps)]


def comparison_sentence(found: Comparison) -> str:
    """Return how far a model is from its logs, and on which joint most.

    Args:
        found: The outcome of ``compare``.
    """
    share = found.relative_rms
    worst = int(np.argmax(share))
    return (
        f"The model of {found.model.robot.name} differs from the measured torque by {percent(float(share.mean()))} "
        f"(mean over the joints), most on {found.model.robot.joints[worst]} ({percent(float(share[worst]))})."
    )


def mean_share(errors: Sequence[float] | np.ndarray, found: Discovery) -> float:
    """Return error over torque RMS, mean over the joints [1].

    Args:
        errors: RMS of each joint [N·m or N], shape (n,).
        found: The outcome of ``discover``.
    """
    return float(np.mean(np.asarray(errors) / np.maximum(found.torque_rms, 1e-12)))


def error_falls(found: Discovery) -> bool:
    """Tell whether what was added lowers the error on data that was not fitted.

    Args:
        found: The outcome of ``discover`` or ``add_effect``.
    """
    first, last = found.trace[0], found.trace[-1]
    return mean_share(last.heldout_rms, found) < NOTICEABLE * mean_share(first.heldout_rms, found)


def _what(steps: Sequence[Step]) -> str:
    if len(steps) <= NAMED:
        return _named(steps)
    return f"{len(steps)} effects (the strongest: {_named(steps[:NAMED])})"


def _named(steps: Sequence[Step]) -> str:
    return listed(effect_words(s.term.effect) for s in steps if s.term)


def _structure_sentences(found: Discovery) -> list[str]:
    left, joints = found.structure_left, found.model.robot.joints
    few, every = len(left) < NAMED, len(left) == len(joints)
    counted = f"all {len(joints)} joints" if every else f"{len(left)} of the {len(joints)} joints"
    where = listed(left) if few else counted
    rest = f"the residual on {where} has structure that no effect explains."
    if not found.steps:
        said = [f"{rest[0].upper()}{rest[1:]}"]
    elif len(found.steps) <= NAMED:
        said = [f"The model of {found.model.robot.name} lacks {_named(found.steps)}; {rest}"]
    else:
        said = [
            f"The model of {found.model.robot.name} lacks {len(found.steps)} effects; {rest}",
            f"The strongest are {_named(found.steps[:NAMED])}.",
        ]
    return said if few or every else [*said, f"The residual still follows the motion on {listed(left)}."]


def _error_sentence(found: Discovery) -> str:
    first, last = found.trace[0], found.trace[-1]
    floor = f"the noise floor is {percent(mean_share(found.noise_floor, found))}"
    before = percent(mean_share(first.rms, found))
    if len(found.trace) == 1:
        return f"The error is {before} of the measured torque (mean over the joints), {floor}."
    after, unseen = percent(mean_share(last.rms, found)), percent(mean_share(last.heldout_rms, found))
    if not error_falls(found):
        return (
            f"The error stays at {after} of the measured torque (mean over the joints); "
            f"on data that was not fitted it is {unseen}, {floor}."
        )
    return (
        f"The error falls from {before} to {after} of the measured torque (mean over the joints); "
        f"on data that was not fitted it is {unseen}, {floor}."
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
    assert step.term is not None
    others = listed(few(confusion_words(c) for c in step.confusions))
    return [
        f"With this motion, {effect_words(step.term.effect)} is hard to distinguish from {others}; "
        f"{advice_words(step.confusions[0].motion)}."
    ]
