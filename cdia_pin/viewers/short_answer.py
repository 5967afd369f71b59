"""The short answer of a discovery: five lines that a user must know."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery.groups import group_of
from cdia_pin.viewers.verdict import mean_share
from cdia_pin.viewers.words import effect_name, joint_units, listed, number, percent, short_names

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Step

MOST_JOINTS = 3  # joints that a line names before it counts the others
VERDICTS = {
    "nothing-missing": "nothing is missing",
    "explained": "explained down to the noise",
    "explained-in-practice": "explained in practice",
    "unexplained": "not explained yet",
}


def short_answer(found: Discovery) -> list[tuple[str, str]]:
    """Return head and text of each line: verdict, where the model fails, what is established, what is likely, its use.

    Args:
        found: The outcome of ``discover``.
    """
    first, last = found.trace[0], found.trace[-1]
    before, after = (percent(mean_share(s.heldout_rms, found)) for s in (first, last))
    fell = f"error {before} of the torque" + ("" if first is last else f", now {after}")
    lines = [(VERDICTS[found.verdict], fell), ("where it fails", _where(found))]
    for confidence in (Confidence.ESTABLISHED, Confidence.LIKELY):
        named = [s for s in found.steps if s.confidence is confidence]
        if named or confidence is Confidence.ESTABLISHED:
            lines.append((str(confidence), "; ".join(group_lines(named, found)) or "nothing"))
    lines.append(("good for", _capability(found)))
    tail = [s for s in found.steps if s.confidence is Confidence.DESCRIPTIVE]
    if tail:
        names = listed(dict.fromkeys(group_of(s.term.effect) for s in tail if s.term))
        lines.append(("only descriptive", f"{names}: lowers the error, and may be something else"))
    return lines


def group_lines(steps: Iterable[Step], found: Discovery) -> list[str]:
    """Return one text per group of effects, such as ``friction on all 6 joints``.

    Args:
        steps: The effects.
        found: The discovery, for the joints.
    """
    groups: dict[str, list[Step]] = {}
    for step in steps:
        assert step.term is not None  # only the first step of a trace is without
        groups.setdefault(group_of(step.term.effect), []).append(step)
    return [_group(name, members, found) for name, members in groups.items()]


def _group(name: str, members: Sequence[Step], found: Discovery) -> str:
    effects = [s.term.effect for s in members if s.term]
    kinds = list(dict.fromkeys(effect_name(e) for e in effects))
    name = kinds[0] if len(kinds) == 1 else name
    joints = list(dict.fromkeys(j for e in effects for j in e.scope))
    changed = " changed" if any(s.change_of_model for s in members) else ""
    return f"{name}{changed}{_on(joints, found)}"


def _on(joints: Sequence[str], found: Discovery) -> str:
    names, every = short_names(found.model.robot.joints), found.model.robot.joints
    if not joints:
        return ""
    if len(joints) == len(every) > 1:
        return f" on all {len(every)} joints"
    if len(joints) > MOST_JOINTS:
        return f" on {len(joints)} joints"
    return f" on {listed(names[j] for j in joints)}"


def _where(found: Discovery) -> str:
    """Return the joints on which structure is left, the worst first, with their error."""
    robot = found.model.robot
    if not found.structure_left:
        return "nowhere: what is left is noise"
    error = found.trace[-1].heldout_rms / np.maximum(found.torque_rms, 1e-12)
    names = short_names(robot.joints)
    worst = sorted(found.structure_left, key=lambda j: -error[robot.joint_index(j)])
    shown = [f"{names[j]} {percent(float(error[robot.joint_index(j)]))}" for j in worst[:MOST_JOINTS]]
    more = f" and {len(worst) - MOST_JOINTS} more" if len(worst) > MOST_JOINTS else ""
    return f"{', '.join(shown)}{more}: structure that no effect explains"


def _capability(found: Discovery) -> str:
    """Return the smallest change that the model lets a user notice."""
    able, robot = found.capability, found.model.robot
    unit = joint_units(robot, robot.joints[0])["load"]
    return f"notices {listed(_noticed(able.payload, able.push, able.friction, unit))}"


def _noticed(payload: float, push: float, friction: np.ndarray, unit: str) -> Iterator[str]:
    if np.isfinite(payload):
        yield f"a payload of {number(payload, 2)} kg"
    if np.isfinite(push):
        yield f"a push of {number(push, 2)} N"
    least, most = (number(float(f), 2) for f in (np.min(friction), np.max(friction)))
    yield f"friction that grows by {least}" + ("" if least == most else f" to {most}") + f" {unit}"


def next_step(found: Discovery, saved: bool, everything: bool) -> str:
    """Return what to type next, in one line.

    Args:
        found: The outcome of ``discover``.
        saved: Whether the model was saved.
        everything: Whether all numbers were shown.
    """
    if not found.steps:
        return "next: cdia monitor LOG --robot …, which watches the arm with this model"
    numbers = "" if everything else "; --all shows the numbers"
    if saved:
        return f"next: cdia discover LATER_LOG --robot … --model MODEL tells what changed{numbers}"
    return f"next: the same with --save model.json keeps the model{numbers}"
