"""Joints of a URDF that are locked because they are not part of the arm.

Fingers, wheels, a torso or a second arm do not move in the equation of motion. They are locked by name, never by
number, and each of them carries its reason.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

from cdia_pin.errors import RobotError, unknown_name
from cdia_pin.robot.joints import LockedJoint
from cdia_pin.robot.urdf import Urdf, UrdfJoint

NOT_ARM = re.compile(r"finger|gripper|thumb|knuckle|jaw|claw|wheel|caster", re.IGNORECASE)

LockRequest = Mapping[str, "float | LockedJoint | None"] | Iterable[str]


@dataclass(frozen=True)
class LockRule:
    """Joints that the catalogue locks.

    Attributes:
        joints: Names, or patterns of names such as ``hand_*``.
        position: Position at which they are locked [rad or m].
        why: The reason, which is shown to the user.
    """

    joints: tuple[str, ...]
    position: float
    why: str


def locked_joints(
    urdf: Urdf, *, lock: LockRequest = (), keep: Iterable[str] = (), rules: Iterable[LockRule] = ()
) -> dict[str, LockedJoint]:
    """Choose the locked joints: on request, by the catalogue, mimic joints, and joints named like a gripper or wheel.

    Args:
        urdf: The robot.
        lock: Names or patterns to lock; a mapping gives positions [rad or m], None for zero or the nearest to it.
        keep: Names that must move although they are named like a finger or a wheel.
        rules: Rules of the catalogue for this robot.

    Returns:
        Locked joints in the order of the file, each with its position and reason.

    Raises:
        RobotError: If a name is unknown, or if ``keep`` names a mimic joint.
    """
    movable = {name: j for name, j in urdf.joints.items() if j.is_movable}
    kept = {name for pattern in keep for name in _matches(pattern, movable)}
    held: dict[str, LockedJoint] = {}
    for pattern, given in _requests(lock):
        for name in _matches(pattern, movable):
            held[name] = given if isinstance(given, LockedJoint) else _at(movable[name], given, "asked for")
    for rule in rules:
        for name in [n for pattern in rule.joints for n in _matches(pattern, movable)]:
            if name not in kept:
                held.setdefault(name, LockedJoint(rule.position, rule.why))
    for name, joint in movable.items():
        if name not in kept and name not in held and joint.mimic is None and _is_no_arm(urdf, joint):
            word = NOT_ARM.search(name)
            held[name] = _at(joint, None, f"its name contains '{word[0].lower() if word else ''}'")
    for name, joint in movable.items():
        if joint.mimic is None or name in held:
            continue
        if name in kept:
            raise RobotError(
                f"joint '{name}' mimics '{joint.mimic.followed}' and has no torque of its own: it cannot be kept"
            )
        held[name] = _mimicking(joint, movable, held, set())
    return {name: held[name] for name in movable if name in held}


def require_chain(urdf: Urdf, held: Mapping[str, LockedJoint]) -> None:
    """Refuse a robot whose moving joints branch.

    Args:
        urdf: The robot.
        held: The locked joints, by name.

    Raises:
        RobotError: If they branch; the message names the branches and the ``lock=`` that keeps one of them.
    """
    children: dict[str | None, list[str]] = {}
    for name, joint in urdf.joints.items():
        if joint.is_movable and name not in held:
            children.setdefault(_moving_parent(urdf, joint, held), []).append(name)
    fork = next((parent for parent, found in children.items() if len(found) > 1), None)
    if all(len(found) <= 1 for found in children.values()):
        return
    at = f"after joint '{fork}'" if fork else "at the base"
    branches = [_subtree(name, children) for name in children[fork]]
    arm = max((_chain(names[0], children) for names in branches), key=len)
    drop = [name for branch in branches for name in branch if name not in arm]
    shown = "; ".join(f"{b[0]}..{b[-1]} ({len(b)} joints)" if len(b) > 1 else b[0] for b in branches)
    moving = [name for name, joint in urdf.joints.items() if joint.is_movable and name not in held]
    patterns = _patterns(drop, [name for name in moving if name not in drop])
    write = shlex.join(["cdia", "robots", str(urdf.path), "--lock", ",".join(patterns), "--save", "arm.urdf"])
    raise RobotError(
        f"robot '{urdf.path.stem}' branches {at}: {shown}. An arm is one chain; to keep {arm[0]}..{arm[-1]}, lock the "
        f"other joints: {write}, then give --robot arm.urdf; or in Python load_robot(..., lock={patterns})"
    )


def _chain(name: str, children: Mapping[str | None, list[str]]) -> list[str]:
    """Return an arm from its first joint on: at a fork it ends, unless a branch is longer than what is before it.

    Fingers fork at the end of an arm; arms fork at the end of a torso.
    """
    chain = [name]
    while below := children.get(chain[-1], []):
        longest = max((_longest(child, children) for child in below), key=len)
        if len(below) > 1 and len(longest) <= len(chain):
            break
        chain.append(longest[0])
    return chain


def _patterns(names: Iterable[str], others: Iterable[str]) -> list[str]:
    """Return the shortest patterns such as ``head_*`` that match all names, and none of some others."""
    others = list(others)
    out: list[str] = []
    for name in names:
        if any(fnmatchcase(name, known) for known in out):
            continue
        starts = (f"{name[: at.end()]}*" for at in re.finditer("_", name))
        out.append(next((p for p in starts if not any(fnmatchcase(o, p) for o in others)), name))
    return out


def _requests(lock: LockRequest) -> list[tuple[str, float | LockedJoint | None]]:
    if isinstance(lock, str):
        return [(lock, None)]
    if isinstance(lock, Mapping):
        return list(lock.items())
    return [(name, None) for name in lock]


def _matches(pattern: str, movable: Mapping[str, UrdfJoint]) -> list[str]:
    found = [name for name in movable if fnmatchcase(name, pattern)]
    if not found:
        raise RobotError(unknown_name("joint", pattern, movable))
    return found


def _is_no_arm(urdf: Urdf, joint: UrdfJoint) -> bool:
    """Tell whether this joint and all joints further out are named like a gripper or wheel: a wrist is not."""
    outer = [j for j in urdf.joints_below(joint.name) if j.is_movable]
    return all(NOT_ARM.search(j.name) or j.mimic is not None for j in (joint, *outer))


def _at(joint: UrdfJoint, position: float | None, reason: str) -> LockedJoint:
    """Lock a joint at the position given, else at zero or the nearest position within its range."""
    if position is None:
        position = min(max(0.0, joint.lower), joint.upper) if joint.lower < joint.upper else 0.0
    return LockedJoint(float(position), reason)


def _mimicking(
    joint: UrdfJoint, movable: Mapping[str, UrdfJoint], held: Mapping[str, LockedJoint], seen: set[str]
) -> LockedJoint:
    """Lock a mimic joint according to the position of its locked leader, or at its offset if the leader moves."""
    mimic = joint.mimic
    assert mimic is not None
    if joint.name in seen:
        raise RobotError(f"joint '{joint.name}' mimics itself")
    followed = movable.get(mimic.followed)
    at = 0.0
    if mimic.followed in held:
        at = held[mimic.followed].position
    elif followed is not None and followed.mimic is not None:
        at = _mimicking(followed, movable, held, seen | {joint.name}).position
    return LockedJoint(mimic.multiplier * at + mimic.offset, f"mimics {mimic.followed}")


def _moving_parent(urdf: Urdf, joint: UrdfJoint, held: Mapping[str, LockedJoint]) -> str | None:
    above = urdf.joint_above(joint.parent)
    while above is not None and (not above.is_movable or above.name in held):
        above = urdf.joint_above(above.parent)
    return above.name if above else None


def _subtree(name: str, children: Mapping[str | None, list[str]]) -> list[str]:
    return [name, *(n for child in children.get(name, []) for n in _subtree(child, children))]


def _longest(name: str, children: Mapping[str | None, list[str]]) -> list[str]:
    tails = [_longest(child, children) for child in children.get(name, [])]
    return [name, *max(tails, key=len, default=[])]
