"""Matching of the joint names of a log with the joints of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.phrases import plural, some

_DIGITS = "0123456789"
MOST_DIGITS = 9  # of a joint's number
_COUNTING_STEMS = {"", "j", "joint", "axis", "a"}  # the last word before the number of a counted joint
_NOT_MEASURED = {"d", "des", "desired", "target", "cmd", "command", "ref", "reference", "set", "goal"}


@dataclass(frozen=True)
class JointNames:
    """The label of each joint of the robot in the log.

    Attributes:
        labels: Labels of the log, in the robot's order.
        note: How the labels were matched; empty if they equal the names of the joints.
    """

    labels: tuple[str, ...]
    note: str = ""


def match_joints(
    given: Sequence[str], joints: Sequence[str], joint_map: Mapping[str, str] | None = None
) -> JointNames:
    """Find the log's label of every joint of a robot.

    Labels are matched by name, after ``joint_map``; then with one beginning or end that all of them have or lack; then
    by number (``q_1`` … ``q_6``, ``joint0`` … ``joint5``), in the robot's order. The only label is that of the only
    joint.

    Args:
        given: Labels of the log.
        joints: Joints of the robot.
        joint_map: {label in the log: joint of the robot} for some or all of them.

    Returns:
        The labels, with a note if something was inferred.

    Raises:
        LogError: If a joint has no label, or more than one match is possible.
    """
    renamed = {label: (joint_map or {}).get(label, label) for label in given}
    by_name = {name: label for label, name in renamed.items()}
    if all(j in by_name for j in joints):
        labels = tuple(by_name[j] for j in joints)
        return JointNames(labels, _note("joints renamed", labels, joints) if joint_map else "")
    if len(given) == len(joints) == 1 and not _words(given[0]) & _NOT_MEASURED:
        return JointNames(tuple(given), _note("the only joint renamed", given, joints))
    if found := _same_but_for_an_end(given, joints):
        return JointNames(
            found, _note("joint names differ from the robot's by one beginning or end", found, joints)
        )
    if found := _counted(given, joints):
        return JointNames(
            found, _note("numbered joints taken in the robot's order (--joint-map changes it)", found, joints)
        )
    missing = [j for j in joints if j not in by_name]
    raise LogError(
        f"no column for {plural('joint', len(missing))} {', '.join(missing)}; "
        f"the log has {some(list(given)) or 'none'}, the robot has {', '.join(joints)}; "
        "name them with --joint-map name=joint,…"
    )


def joint_map_of(given: Mapping[str, str] | Sequence[str] | None) -> dict[str, str]:
    """Read a joint map from a dict or from texts.

    Args:
        given: {name in the log: joint}, or texts ``name=joint``, several separated by commas.

    Returns:
        {name in the log: joint}; empty for None.

    Raises:
        LogError: If a text is not of this form.
    """
    if given is None or isinstance(given, Mapping):
        return dict(given or {})
    out = {}
    for text in [given] if isinstance(given, str) else given:
        for part in text.split(","):
            label, equals, joint = part.partition("=")
            if not equals or not label.strip() or not joint.strip():
                raise LogError(f"joint_map: '{part}' is not of the form name=joint")
            out[label.strip()] = joint.strip()
    return out


def check_joint_map(joint_map: Mapping[str, str], given: Sequence[str], joints: Sequence[str]) -> None:
    """Check that a joint map names existing labels and joints, each joint once.

    Args:
        joint_map: {name in the log: joint of the robot}.
        given: Labels of the log.
        joints: Joints of the robot.

    Raises:
        LogError: If a label or a joint is unknown, or a joint is named twice.
    """
    for label, joint in joint_map.items():
        if label not in given:
            raise LogError("joint_map: " + unknown_name("name in the log", label, given))
        if joint not in joints:
            raise LogError("joint_map: " + unknown_name("joint", joint, joints))
    twice = [j for j in joints if list(joint_map.values()).count(j) > 1]
    if twice:
        raise LogError(f"joint_map gives more than one name to {', '.join(twice)}")


def _same_but_for_an_end(given: Sequence[str], joints: Sequence[str]) -> tuple[str, ...] | None:
    """Match labels that have or lack one beginning or one end that is the same for all joints."""
    known = set(given)
    readings = dict.fromkeys(r for label in given for r in _readings(label, joints))
    possible = [r for r in readings if all(label in known for label in r)]
    measured = [r for r in possible if not _words(_added(r[0], joints[0])) & _NOT_MEASURED]
    if len(measured) > 1:
        starts = some([f"'{r[0]}' …" for r in measured])
        raise LogError(f"joint {joints[0]} could be {starts}; choose one with --joint-map name=joint,…")
    return measured[0] if measured else None


def _readings(label: str, joints: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield the labels of all joints, if a label is the first joint but for its beginning or its end."""
    first = joints[0]
    if not label:
        return
    if label.endswith(first):
        beginning = label.removesuffix(first)
        yield tuple(beginning + j for j in joints)
    if label.startswith(first):
        end = label.removeprefix(first)
        yield tuple(j + end for j in joints)
    if first.endswith(label):
        beginning = first.removesuffix(label)
        if all(j.startswith(beginning) for j in joints):
            yield tuple(j.removeprefix(beginning) for j in joints)
    if first.startswith(label):
        end = first.removeprefix(label)
        if all(j.endswith(end) for j in joints):
            yield tuple(j.removesuffix(end) for j in joints)


def _added(label: str, joint: str) -> str:
    """Return what a label has beyond the name of its joint; all of it, if it has less than the name."""
    return label.removeprefix(joint) if label.startswith(joint) else label.removesuffix(joint)


def _counted(given: Sequence[str], joints: Sequence[str]) -> tuple[str, ...] | None:
    """Match labels of one stem with the numbers 0 … n−1 or 1 … n, by number."""
    groups: dict[str, dict[int, str]] = {}
    for label in given:
        stem = label.rstrip(_DIGITS)
        digits = label[len(stem) :]
        if 0 < len(digits) <= MOST_DIGITS:
            groups.setdefault(stem, {})[int(digits)] = label
    fitting = []
    for stem, members in groups.items():
        numbers = sorted(members)
        words = re.split(r"[._/ ]+", stem.lower().rstrip("._/ "))
        counted = words[-1] in _COUNTING_STEMS and not set(words) & _NOT_MEASURED
        if (
            counted
            and len(numbers) == len(joints)
            and numbers[0] in {0, 1}
            and numbers[-1] - numbers[0] + 1 == len(joints)
        ):
            fitting.append(tuple(members[k] for k in numbers))
    return fitting[0] if len(fitting) == 1 else None


def _words(text: str) -> set[str]:
    return set(re.split(r"[._/ ]+", text.lower()))


def _note(what: str, labels: Sequence[str], joints: Sequence[str]) -> str:
    return f"{what}: " + ", ".join(f"{a} → {b}" for a, b in zip(labels, joints, strict=True) if a != b)
