"""What changed between logs, in words and rows that the terminal and the report share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.changes.changes_result import ChangesVerdict
from cdia_pin.changes.overlap import NotCompared
from cdia_pin.changes.run_to_run import as_phenomena
from cdia_pin.phrases import numbered
from cdia_pin.viewers.effect_groups import MOST_RIVALS, rivals, these_joints
from cdia_pin.viewers.words import (
    advice_words,
    confusion_words,
    effect_name,
    effect_words,
    joint_units,
    listed,
    number,
    parameter_name,
    percent,
    sentence_case,
    short_names,
    with_interval,
    with_sign,
    with_unit,
)

if TYPE_CHECKING:
    from cdia_pin.changes import Change, Changes
    from cdia_pin.changes.confidence import Confidence
    from cdia_pin.discovery import Comparison
    from cdia_pin.effects import Term

NAMED = 3  # changes that the verdict names before it counts the others
# Between halves of one log, 1 % of 296 comparisons have such a spread; between two motions of a UR10e 83 % of 60, and
# between eight of a UR5 62 % of 56. With 1.25 it is 6, 97 and 73 %, with 2 it is 0.3, 42 and 21 %.
WIDE = 1.5  # spread of certainties [1] from which on the answer says that the model fails differently in each log
MANY = 4  # parameters; of an effect with more, only those whose interval excludes zero are listed


@dataclass(frozen=True)
class ChangeRow:
    """A change as a row of a table.

    Attributes:
        name: Name of the effect.
        where: Its joints, or that it is of the whole arm.
        differences: Name and text of each parameter that counts.
        growth: By which share of what was there before it grew, in words; empty if that is not known.
        torque: Largest RMS torque of a joint in the logs that have it, with the joint.
        confidence: How far the name can be trusted.
    """

    name: str
    where: str
    differences: tuple[str, ...]
    growth: str
    torque: str
    confidence: Confidence


def change_rows(found: Changes) -> list[ChangeRow]:
    """Return a row for each change.

    Args:
        found: The outcome of ``what_changed``.
    """
    robot, names = found.model.robot, short_names(found.model.robot.joints)
    out = []
    for c in found.changes:
        j = int(np.argmax(c.torque_rms))
        size = with_unit(number(c.torque_rms[j], 2), joint_units(robot, robot.joints[j])["load"])
        out.append(
            ChangeRow(
                effect_name(c.term.effect),
                listed(names[s] for s in c.term.effect.scope) or "whole arm",
                tuple(f"{name} {text}" for name, text, _ in _differences(c.term, found)),
                "" if c.growth is None else _signed(percent(abs(c.growth)), c.growth),
                f"{size} ({names[robot.joints[j]]})",
                c.confidence,
            )
        )
    return out


def names_of_logs(comparisons: Sequence[Comparison]) -> list[str]:
    """Return the names of the logs that a model was compared with; repeated names are numbered.

    Args:
        comparisons: The outcome of ``compare`` for each log.
    """
    out: list[str] = []
    for c in comparisons:
        out.append(numbered(c.record["logs"][0]["source"], out))
    return out


def changes_sentence(found: Changes) -> str:
    """Return the verdict in one sentence.

    Args:
        found: The outcome of ``what_changed``.
    """
    before, after = (listed(dict.fromkeys(names)) for names in (found.before, found.after))
    if found.verdict is ChangesVerdict.NOT_COMPARABLE:
        return (
            f"Whether anything changed from {before} to {after} cannot be told: no joint moves alike in both."
        )
    said = [f.sentence for f in found.findings]
    if not found.changes and not said:
        shown = "No change is certain" if found.uncertain else "These logs show no change"
        return f"{shown} from {before} to {after}."
    if not found.changes:
        beside = "no change is certain" if found.uncertain else "these logs show no change"
        return f"From {before} to {after}: {'; '.join(said)}. Beside that, {beside}."
    described = [change_words(c, found) for c in found.changes]
    few = (
        listed(described)
        if len(described) <= NAMED
        else f"{', '.join(described[:NAMED])} and {len(described) - NAMED} more"
    )
    return f"From {before} to {after}: {'; '.join([*said, few])}."


def is_quiet(found: Changes) -> bool:
    """Tell whether nothing changed, as far as the logs tell, and nothing seems to have.

    Args:
        found: The outcome of ``what_changed``.
    """
    return found.verdict is ChangesVerdict.UNCHANGED and not found.uncertain


def change_words(change: Change, found: Changes) -> str:
    """Return ``coulomb friction on elbow +2.10 ± 0.12 N·m (+40 %)``.

    Of several parameters it states the main one. If the interval of that one holds zero, it states the one that is
    farthest from zero in units of its interval, by name.

    Args:
        change: One of them.
        found: All of them.
    """
    grown = f" ({_signed(percent(abs(change.growth)), change.growth)})" if change.growth is not None else ""
    return f"{_words(change.term, found)}{grown}"


def _words(term: Term, found: Changes) -> str:
    """Return an effect, its joints, and the difference that stands for it in a sentence."""
    names = short_names(found.model.robot.joints)
    where = f" on {listed(names[j] for j in term.effect.scope)}" if term.effect.scope else ""
    rows = _differences(term, found)
    main = parameter_name(term.effect.parameters[0].name)
    certain = [row for row in rows if row[2] > 1] or rows[:1] or [("", "", 0.0)]
    name, text, _ = max(certain, key=lambda row: (row[0] == main, row[2]))
    stated = f" {text}" if name == main else f" {name} {text}".rstrip()
    return f"{effect_name(term.effect)}{where}{stated}"


def _differences(term: Term, found: Changes) -> list[tuple[str, str, float]]:
    """Return name and text of each difference that counts, and its size in half widths of its interval [1]."""
    robot = found.model.robot
    intervals = term.ci95 or ((float("nan"),) * 2,) * len(term.theta)
    rows = list(zip(term.effect.parameters, term.theta, term.effect.units(robot), intervals, strict=True))
    out = [
        (parameter_name(p.name), with_sign(with_interval(v, ci, unit), v), _distance_from_zero(v, ci))
        for p, v, unit, ci in rows
    ]
    return [row for row in out if row[2] > 1] if len(out) > MANY else out


def _distance_from_zero(value: float, interval: tuple[float, float]) -> float:
    """Return a value over the half of its interval that is towards zero [1]; above one the interval leaves zero out."""
    towards = value - interval[0] if value > 0 else interval[1] - value
    return abs(value) / towards if towards > 0 else 0.0


def _signed(text: str, value: float) -> str:
    return ("+" if value > 0 else "−") + text


def doubts(found: Changes) -> list[str]:
    """Return which changes could be others, by the motion that would distinguish them; the nearest few of each.

    Args:
        found: The outcome of ``what_changed``.
    """
    by_motion: dict[str, list[str]] = {}
    for c in found.changes:
        effect = c.term.effect
        for x in rivals(effect, c.confusions)[:MOST_RIVALS]:
            by_motion.setdefault(x.motion, []).append(f"{effect_words(effect)} ↔ {confusion_words(x)}")
    return [
        f"Hard to distinguish: {', '.join(pairs)}. {sentence_case(advice_words(motion))}."
        for motion, pairs in by_motion.items()
    ]


def notes(found: Changes) -> list[str]:
    """Return what else is said: usual differences, and what could have changed unseen.

    Args:
        found: The outcome of ``what_changed``.
    """
    usual = as_phenomena(found.usual, found.findings)
    return [*_uncertain(found), *(f"{sentence_case(f.sentence)}." for f in usual), *_bounds(found)]


def _uncertain(found: Changes) -> list[str]:
    """Return what may have changed as well, with its certainty beside that of a name."""
    told = [
        f"{_words(u.term, found)} ({percent(u.share)} of the certainty that a name needs)"
        for u in found.uncertain[:NAMED]
    ]
    return [f"Too uncertain to be named, and perhaps a change: {listed(told)}."] if told else []


def _bounds(found: Changes) -> list[str]:
    """Return the largest change of each joint that could stay hidden, and the joints of which nothing is known."""
    robot, names = found.model.robot, short_names(found.model.robot.joints)
    said, sentences = [], []
    for joint, bound in found.bounds.items():
        size = with_unit(number(bound.torque, 2), joint_units(robot, joint)["load"])
        share = percent(found.share_of(joint))
        said.append(f"{names[joint]} {size} ({share} of its torque, {effect_name(bound.term.effect)})")
    if said:
        other = "The largest other change" if found.changes else "The largest change"
        sentences.append(f"{other} of one parameter that these logs would not show (RMS): {', '.join(said)}.")
    if said and found.spread >= WIDE:
        times = number(found.spread, 2)
        advice = (
            "The motion is the same, so something may have changed that no known effect describes."
            if found.same_motion
            else "The same motion in both logs would show smaller changes."
        )
        sentences.append(
            f"The model fails differently in each log: effects that are not there seem {times} times as certain as by "
            f"chance. {advice}"
        )
    unsure = [j for j in robot.joints if j not in found.bounds and j not in found.not_compared]
    if unsure:
        where = these_joints(unsure, robot.joints)
        sentences.append(f"No bound for {where}: even a change as large as its torque could stay hidden.")
    if found.not_compared:
        why = {
            NotCompared.RESTS_BEFORE: f"at rest in {listed(found.before)} (or too slow for its encoder)",
            NotCompared.RESTS_AFTER: f"at rest in {listed(found.after)} (or too slow for its encoder)",
            NotCompared.OTHER_SPEEDS: "hardly ever at the same speeds in both",
            NotCompared.NO_EFFORT: "without an effort in one of them",
        }
        joints = {w: [j for j, of in found.not_compared.items() if of is w] for w in NotCompared}
        each = [f"{these_joints(js, robot.joints)}, {why[w]}" for w, js in joints.items() if js]
        recorded = " with their efforts" if joints[NotCompared.NO_EFFORT] else ""
        sentences.append(
            f"Not compared: {'; '.join(each)}. To compare them, record a motion{recorded} twice in which each of them "
            "moves."
        )
    return sentences
