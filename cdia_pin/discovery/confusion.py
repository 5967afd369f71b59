"""Confusions: other explanations that this motion tells poorly from the one that was found."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.discovery.evidence import Evidence
from cdia_pin.discovery.result import Confusion
from cdia_pin.discovery.moves import ranked

DOUBT = 12.0  # difference of cost up to which two explanations count as hard to tell apart
SAME = 0.01  # or the share of what the effect explains by which the other may fall short


def find_confusions(evidence: Evidence, chosen: Sequence[int], one: int, most: int = 4) -> tuple[Confusion, ...]:
    """Return the effects that would explain nearly as much in the place of one that was found.

    Args:
        evidence: Normal equations of all candidates around the final model.
        chosen: The found effects.
        one: Which of them.
        most: How many confusions to report.
    """
    rest = [c for c in chosen if c != one]
    with_it, without = evidence.fit(chosen), evidence.fit(rest)
    tolerated = max(DOUBT, SAME * (without.chi2 - with_it.chi2))
    found: list[tuple[float, Confusion]] = []
    seen = {evidence.effects[c].label for c in chosen}
    for other in ranked(evidence, rest, 4 * most, spare=tolerated):
        effect = evidence.effects[other]
        if effect.label in seen:
            continue
        fit = evidence.fit([*rest, other])
        if fit.physical and fit.cost - with_it.cost < tolerated:
            seen.add(effect.label)
            found.append((fit.cost, Confusion((effect,), motion_between(evidence.effects[one].name, effect.name))))
    return tuple(c for _, c in sorted(found, key=lambda f: f[0])[:most])


MOTIONS = {
    "sign": "move the joint both ways at several constant speeds, slow and fast",
    "speed": "move the joint at several constant speeds up to its fastest",
    "acceleration": "reverse quickly at small amplitude, then move at constant speed",
    "gravity": "hold the arm in poses with gravity on and off the joint, at rest and moving slowly",
    "position": "sweep the joint slowly over its whole range, both ways",
    "wrist": "turn the wrist through all orientations, at two reaches of the arm",
}
NEEDS = {
    "coulomb_friction": "sign",
    "asymmetric_friction": "sign",
    "stribeck_friction": "speed",
    "viscous_friction": "speed",
    "quadratic_friction": "speed",
    "coupled_friction": "speed",
    "viscous_medium": "speed",
    "rotor_inertia": "acceleration",
    "effort_delay": "acceleration",
    "load_friction": "gravity",
    "actuator_gain": "gravity",
    "torque_offset": "gravity",
    "base_tilt": "gravity",
    "encoder_offset": "gravity",
    "joint_spring": "position",
    "position_ripple": "position",
    "payload": "wrist",
    "tool_wrench": "wrist",
    "link_inertia": "wrist",
}


def motion_between(one: str, other: str) -> str:
    """Return in words a motion in which two effects differ."""
    needs = dict.fromkeys(NEEDS.get(name, "position") for name in (one, other))
    return "; ".join(MOTIONS[n] for n in needs)
