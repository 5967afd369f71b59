"""What the program named, read from its JSON: the same words from every flow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, isfinite, nan
from typing import Any, Self

from cdia_pin.changes import Changes
from cdia_pin.discovery import Discovery
from cdia_pin.effects import EFFECTS
from cdia_pin.robot import RobotModel

NAMED = (
    "",
    "established",
    "likely",
)  # confidences that count; a program that gives none means all that it names
ESTABLISHED = ("", "established")
SEVERAL = "link_inertia"  # one name for one link or several
Interval = tuple[float, float]


@dataclass(frozen=True)
class Named:
    """An effect that was named.

    Attributes:
        label: Its name and joints; a body on the last link is a payload.
        confidence: As the program gives it; empty if it gives none.
        group: The group that it is shown in; empty if there is none.
        values: Its parameters by name.
        intervals: Their 95 % intervals, where there are any.
    """

    label: str
    confidence: str
    group: str
    values: dict[str, float]
    intervals: dict[str, Interval]

    @property
    def effect(self) -> str:
        """Name of the effect without its joints."""
        return self.label.partition("@")[0]

    @classmethod
    def of(cls, entry: Mapping[str, Any], parameters: str, robot: RobotModel) -> Self:
        """Read an entry of the program's JSON.

        Args:
            entry: An effect or a change.
            parameters: Key of its parameters.
            robot: The arm.
        """
        given = entry[parameters]
        return cls(
            label_of(entry, robot),
            str(entry.get("confidence", "")),
            str(entry.get("group") or ""),
            {k: float(p["value"]) for k, p in given.items()},
            {k: (float(p["ci95"][0]), float(p["ci95"][1])) for k, p in given.items() if p.get("ci95")},
        )

    def negated(self) -> Self:
        """Return the effect with the other sign, as if the logs were exchanged."""
        values = {k: -v for k, v in self.values.items()}
        return replace(self, values=values, intervals={k: (-b, -a) for k, (a, b) in self.intervals.items()})

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> Self:
        """Read back what was kept."""
        intervals = {k: (float(v[0]), float(v[1])) for k, v in given["intervals"].items()}
        return cls(**{**given, "intervals": intervals})


def label_of(entry: Mapping[str, Any], robot: RobotModel) -> str:
    """Return the name of an effect with the joints that it names.

    Args:
        entry: An effect of the program's JSON, whose joints are all joints for an effect of the whole arm.
        robot: The arm.
    """
    name, joints = str(entry["effect"]), list(entry["joints"])
    if name == SEVERAL and joints == [robot.tool_joint]:
        return "payload"
    whole_arm = name in EFFECTS and name != SEVERAL and len(joints) > len(EFFECTS[name].scope_fields)
    scope = [] if whole_arm else sorted(joints, key=robot.joint_index)
    varies = "[varies]" if entry.get("varies") else ""
    return name + ("@" + "+".join(scope) if scope else "") + varies


def of_changes(found: Changes) -> tuple[Named, ...]:
    """Return what a comparison named."""
    entries = found.to_dict()["changes"]
    return _named([Named.of(e, "difference", found.model.robot) for e in entries])


def of_discovery(found: Discovery) -> tuple[Named, ...]:
    """Return what a discovery named, beyond the model that it began with."""
    entries = found.to_dict()["effects"]
    return _named([Named.of(e, "parameters", found.model.robot) for e in entries])


def differences(untouched: Sequence[Named], touched: Sequence[Named]) -> tuple[Named, ...]:
    """Return by what two discoveries of one log differ: effects that one lacks, and those that moved.

    Args:
        untouched: Found in the log as it is.
        touched: Found in the log with an effect put into it.
    """
    return tuple(_differences({n.label: n for n in untouched}, {n.label: n for n in touched}))


def _differences(before: Mapping[str, Named], after: Mapping[str, Named]) -> Iterator[Named]:
    for label, there in after.items():
        if label not in before:
            yield there
        elif _moved(before[label], there):
            yield difference(before[label], there)
    for label, gone in before.items():
        if label not in after:
            yield replace(gone.negated(), intervals={})


def difference(before: Named, after: Named) -> Named:
    """Return an effect whose parameters are after less before, with intervals of independent estimates."""
    shared = [k for k in after.values if k in before.values]
    values = {k: after.values[k] - before.values[k] for k in shared}
    wide = {k: hypot(half(before, k), half(after, k)) for k in shared}
    intervals = {k: (values[k] - w, values[k] + w) for k, w in wide.items() if isfinite(w)}
    return Named(after.label, after.confidence, after.group, values, intervals)


def half(named: Named, parameter: str) -> float:
    """Return half the width of a parameter's interval; NaN where it has none."""
    low, high = named.intervals.get(parameter, (nan, nan))
    return (high - low) / 2


def _moved(before: Named, after: Named) -> bool:
    between = difference(before, after)
    return any(low > 0 or high < 0 for low, high in between.intervals.values())


def _named(all_of_them: Sequence[Named]) -> tuple[Named, ...]:
    return tuple(n for n in all_of_them if n.confidence in NAMED)
