"""The parameters of a term in words, with the two parts of their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

import numpy as np

from cdia_pin.viewers.effect_groups import EffectGroup, term_of
from cdia_pin.viewers.report_series import Numbers, compact
from cdia_pin.viewers.words import (
    half_widths,
    joint_units,
    number,
    parameter_name,
    with_interval,
    with_sign,
    with_unit,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Step
    from cdia_pin.effects import Term
    from cdia_pin.robot.model import RobotModel

FEW = 2  # parameters of an effect that fit in one line
PARTS = ("statistical", "systematic")
SINCE = "since the model"  # said of a difference from the model as given


class ParameterRow(TypedDict):
    """A parameter in words.

    Attributes:
        name: In words.
        text: Its value with its 95 % interval and unit.
        parts: Half widths of the statistical and the systematic part of the interval, in its unit; empty where they
            are not known.
        interval: Lower end, value and upper end; None without an interval.
        telling: Whether the interval leaves out zero.
    """

    name: str
    text: str
    parts: list[str]
    interval: Numbers | None
    telling: bool


class ShapeRow(TypedDict):
    """A shape parameter in words."""

    name: str
    text: str


def parameters(term: Term, robot: RobotModel, *, differences: bool = False) -> list[ParameterRow]:
    """Return the parameters of a term in words, with their intervals.

    Args:
        term: An effect with numbers.
        robot: The arm, for the units.
        differences: Whether the numbers are changes since the model as given.
    """
    totals = term.ci95 or (None,) * len(term.theta)
    statistical = term.ci95_statistical or (None,) * len(term.theta)
    units = term.effect.units(robot)
    out: list[ParameterRow] = []
    for p, value, unit, total, narrow in zip(
        term.effect.parameters, term.theta, units, totals, statistical, strict=True
    ):
        text = with_interval(value, total, unit)
        out.append({
            "name": parameter_name(p.name),
            "text": f"{with_sign(text, value)} {SINCE}" if differences else text,
            "parts": _parts(total, narrow),
            "interval": None if total is None else compact([total[0], value, total[1]]),
            "telling": total is None or not bool(total[0] <= 0.0 <= total[1]),
        })  # fmt: skip
    return out


def step_parameters(step: Step, robot: RobotModel) -> list[ParameterRow]:
    """Return the parameters of an effect that was found; of a changed one, its differences.

    Args:
        step: A step that added an effect.
        robot: The arm, for the units.
    """
    return parameters(term_of(step), robot, differences=step.change_of_model)


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


def _parts(total: tuple[float, float] | None, statistical: tuple[float, float] | None) -> list[str]:
    """Return the half widths of the statistical and the systematic part of an interval."""
    if total is None or statistical is None:
        return []
    wide, narrow = (float(high - low) / 2 for low, high in (total, statistical))
    if not np.isfinite(wide):
        return []
    return list(half_widths(narrow, float(np.sqrt(max(wide**2 - narrow**2, 0.0)))))


def parts_words(row: ParameterRow) -> str:
    """Return ``± 0.04 statistical, ± 0.10 systematic``; empty where the parts are not known.

    Args:
        row: A parameter in words.
    """
    return ", ".join(f"± {w} {sort}" for w, sort in zip(row["parts"], PARTS, strict=False))


def group_numbers(group: EffectGroup, robot: RobotModel) -> str:
    """Return the numbers of a group in one line: those of one effect, or the range over the joints.

    Args:
        group: Effects of one kind.
        robot: The arm, for the units.
    """
    if len(group.steps) == 1:
        told = [p for p in step_parameters(group.steps[0], robot) if p["telling"]]
        return ", ".join(f"{p['name']} {p['text']}" for p in told) if len(told) <= FEW else ""
    terms = [term_of(s) for s in group.steps]
    kinds = {(t.effect.name, t.effect.units(robot)) for t in terms}
    if len(kinds) > 1 or terms[0].effect.size > 1:
        return ""
    values = sorted(t.theta[0] for t in terms)
    least, most = (number(v, 2) for v in (values[0], values[-1]))
    if group.changed:
        least, most = with_sign(least, values[0]), with_sign(most, values[-1])
    name = parameter_name(terms[0].effect.parameters[0].name)
    text = f"{name} {with_unit(f'{least} to {most}', terms[0].effect.units(robot)[0])}"
    return f"{text} {SINCE}" if group.changed else text
