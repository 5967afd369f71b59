"""What the data's README knows of the arms, against what was found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import nan

from benchmarks.claims import Figure, at_least, at_most, counted
from benchmarks.markdown import Row
from benchmarks.real_residuals.answers import Named, half
from benchmarks.real_residuals.bases import Base
from benchmarks.real_residuals.cases import COMPARE, KNOWN, MODEL
from benchmarks.real_residuals.draws import OF_THE_MOTOR
from benchmarks.real_residuals.judging import row
from benchmarks.real_residuals.outcome import Outcome
from cdia_pin.viewers.words import number

PAYLOAD_WIDTH = 0.12  # [1], half the widest interval of the UR10e's payload over its mass
HAND, HAND_TOLERANCE = -0.76, 0.1  # [kg], the Panda's hand, which is in the URDF and was not on the arm
PENDULUM = {  # true parameters: friction [N·m], rotor inertia at the joint [kg·m²]
    ("coulomb_friction@shoulder", "level"): 0.16,
    ("coulomb_friction@elbow", "level"): 0.12,
    ("rotor_inertia@shoulder", "inertia"): 0.0022,
    ("rotor_inertia@elbow", "inertia"): 0.0022,
}
EXOTIC = ("viscous_medium", "tool_wrench")  # all arms stood in air, and nothing touched them
ONE_DEGREE = 0.171  # [m/s²], of gravity; all arms stood upright, but not to less than a degree


def truths(outcomes: Sequence[Outcome], bases: Mapping[str, Base]) -> Iterator[Row]:
    """Yield a row for each truth.

    Args:
        outcomes: Of all cases.
        bases: What was found in untouched logs, by name.
    """
    for flow, title in ((COMPARE, "`compare`"), (MODEL, "`discover --model`")):
        chosen = [o for o in outcomes if o.effect == KNOWN and o.flow == flow and not o.variant]
        yield _payload(title, chosen)
    if (panda := bases.get("panda/exciting")) is not None:
        yield _hand(panda)
    swings = [bases[k] for k in bases if bases[k].arm == "double_pendulum" and bases[k].whole]
    for (label, parameter), true in PENDULUM.items() if swings else ():
        yield _pendulum(swings, label, parameter, true)
    if (lwr4 := bases.get("kuka_lwr4/exciting")) is not None:
        wrong = [n.label for n in lwr4.named if n.effect in {*OF_THE_MOTOR, *EXOTIC}]
        text = "LWR4+: friction of a motor, rotor, medium or wrench named"
        yield row(text, "none", Figure(len(wrong), 1, ", ".join(wrong) or "none"), at_most(0))
    whole = [b for b in bases.values() if b.whole]
    exotic = [f"{n.label} ({b.id})" for b in whole for n in b.named if _is_exotic(n)]
    if whole:
        figure = Figure(len(exotic), len(whole), ", ".join(exotic) or "none")
        yield row("exotic effects named on any arm", "none", figure, at_most(0))


def _payload(title: str, outcomes: Sequence[Outcome]) -> Row:
    right = counted(
        [o.held.get("mass", False) and o.widths.get("mass", nan) <= PAYLOAD_WIDTH for o in outcomes]
    )
    said = "; ".join(f"{_value(_found(o.named, 'payload'), 'mass')} kg{_beside(o)}" for o in outcomes)
    text = f"UR10e: 2.6 kg by {title}, inside an interval of ±{PAYLOAD_WIDTH:.0%} at most"
    return row(text, "all", Figure(right.value, right.n, said or "–"), at_least(1.0))


def _beside(o: Outcome) -> str:
    others = sum(n.label != "payload" for n in o.named)
    return f" and {others} other effects" if others else ""


def _hand(panda: Base) -> Row:
    hand = _found(panda.named, "payload")
    mass = hand.values["mass"] if hand else 0.0
    return row(
        "Panda: mass of the hand that the URDF has and the arm had not",
        f"{HAND} ± {HAND_TOLERANCE} kg",
        Figure(mass, 1, f"{_value(hand, 'mass')} kg"),
        lambda m: abs(m - HAND) <= HAND_TOLERANCE,
    )


def _pendulum(swings: Sequence[Base], label: str, parameter: str, true: float) -> Row:
    found = [_found(b.named, label) for b in swings]
    held = [n is not None and abs(n.values[parameter] - true) <= half(n, parameter) for n in found]
    figure = counted(held)
    said = "; ".join(_value(n, parameter) for n in found)
    text = f"double pendulum: {label}, {true:g} inside its interval"
    return row(text, "all", Figure(figure.value, figure.n, said), at_least(1.0))


def _is_exotic(named: Named) -> bool:
    if named.effect == "base_tilt":
        return any(abs(v) > ONE_DEGREE for v in named.values.values())
    return named.effect in EXOTIC


def _found(named: Sequence[Named], label: str) -> Named | None:
    return next((n for n in named if n.label == label), None)


def _value(named: Named | None, parameter: str) -> str:
    if named is None or parameter not in named.values:
        return "not named"
    return f"{number(named.values[parameter], 3)} ± {number(half(named, parameter), 2)}"
