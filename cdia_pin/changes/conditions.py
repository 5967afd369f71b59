"""Conditions of several logs, and the effects that differ between the conditions."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.changes.changes_result import Changes
from cdia_pin.changes.detection import what_changed
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Channel, PerLog, Term, Varying
from cdia_pin.logs.log import Log
from cdia_pin.progress import Progress
from cdia_pin.selection.discovery_settings import DiscoverySettings


def by_condition(logs: Sequence[Log]) -> list[list[Log]]:
    """Return the logs of each condition; a log without a condition is a group of its own.

    Args:
        logs: The logs; groups come in the order of their first log.
    """
    groups: dict[object, list[Log]] = {}
    for k, log in enumerate(logs):
        groups.setdefault(log.condition or k, []).append(log)
    return list(groups.values())


def changes_between(
    model: Dynamics, logs: Sequence[Log], settings: DiscoverySettings, progress: Progress | None = None
) -> tuple[Changes, ...]:
    """Return what changed from the first condition to each other one; nothing if there is only one condition.

    Args:
        model: The model of the arm as it is known.
        logs: Logs of one arm.
        settings: What may have changed, and how logs are conditioned.
        progress: Called with a sentence and the share done.
    """
    first, *others = by_condition(logs)
    return tuple(what_changed(model, first, other, settings=settings, progress=progress) for other in others)


def effects_that_differ(changes: Sequence[Changes]) -> tuple[str, ...]:
    """Return the labels of the effects whose parameters differ between conditions.

    Friction that differs as it usually does from run to run is among them: the arm is the same, its friction is not.
    An encoder offset is not among them, because it moves the arm and has one value in a model.

    Args:
        changes: Changes from the first condition to each other one.
    """
    terms = [c.term for found in changes for c in found.changes]
    changed = [t.label for t in terms if t.effect.traits.channel is not Channel.POSITION_READING]
    usual = [label for found in changes for u in found.usual for label in u.effects]
    return tuple(dict.fromkeys([*changed, *usual]))


def with_parameters_per_log(model: Dynamics, logs: tuple[str, ...], asked: Sequence[str]) -> Dynamics:
    """Return a model in which some terms have parameters per log.

    Args:
        model: The model.
        logs: Names of the logs or conditions.
        asked: Names or labels of the effects that get parameters per log.
    """
    terms = tuple(
        Term(PerLog(t.effect, logs), t.theta * len(logs), t.profile)
        if {t.effect.name, t.label} & set(asked) and not isinstance(t.effect, Varying)
        else t
        for t in model.terms
    )
    return Dynamics(model.robot, terms)
