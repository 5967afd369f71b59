"""Confusions: other explanations that this motion tells poorly from the one that was found."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.discovery.evidence import Evidence
from cdia_pin.discovery.moves import ranked
from cdia_pin.discovery.result import Confusion
from cdia_pin.effects import Effect
from cdia_pin.effects.inertia import Body
from cdia_pin.robot.model import RobotModel

DOUBT = 30.0  # difference of cost up to which two explanations count as hard to tell apart


def find_confusions(
    evidence: Evidence, chosen: Sequence[int], one: int, most: int = 4
) -> tuple[Confusion, ...]:
    """Return what would explain nearly as much in the place of an effect, or of it and another on its joint.

    Args:
        evidence: Normal equations of all candidates around the final model.
        chosen: The found effects.
        one: Which of them.
        most: How many confusions to report.
    """
    found = evidence.fit(chosen)
    tolerated = DOUBT * max(
        1.0, found.chi2 / max(evidence.samples, 1)
    )  # structure that is left makes all less sure
    limit = found.cost + tolerated
    taken = {evidence.effects[c].label for c in chosen}
    rivals: dict[str, tuple[float, int]] = {}
    for replaced in ([one], *([one, c] for c in _neighbours(evidence, chosen, one))):
        rest = [c for c in chosen if c not in replaced]
        for other in ranked(evidence, rest, 3 * most, spare=tolerated + 4 * evidence.price_per_parameter):
            label = evidence.effects[other].label
            spare = evidence.price_per_parameter * evidence.freedom[other]
            if label in taken or evidence.bound([*rest, other]) - spare > limit:
                continue
            fit = evidence.fit([*rest, other])
            # a rival that needs only some of its parameters is as simple as they are
            idle = (
                max(evidence.freedom[other] - evidence.told_from_zero(fit, other), 0.0)
                if len(replaced) > 1
                else 0.0
            )
            cost = fit.cost - evidence.price_per_parameter * idle
            if fit.physical and cost < min(limit, rivals.get(label, (limit, 0))[0]):
                rivals[label] = (cost, other)
    best = [evidence.effects[c] for _, c in sorted(rivals.values())[:most]]
    return tuple(Confusion((e,), motion_between(evidence.effects[one], e, evidence.robot)) for e in best)


def _neighbours(evidence: Evidence, chosen: Sequence[int], one: int) -> list[int]:
    """Return the other found effects that act on just the same joint."""
    joints = evidence.effects[one].acts_on(evidence.robot)
    alone = len(joints) == 1
    return [c for c in chosen if alone and c != one and evidence.effects[c].acts_on(evidence.robot) == joints]


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


def motion_between(one: Effect, other: Effect, robot: RobotModel) -> str:
    """Return in words a motion in which two effects differ."""
    if isinstance(one, Body) and isinstance(other, Body) and one.carrier(robot) == other.carrier(robot):
        return "no motion does, both are a body on the same link: repeat the log with the tool taken off"
    needs = dict.fromkeys(NEEDS.get(e.name, "position") for e in (one, other))
    return "; ".join(MOTIONS[n] for n in needs)
