"""Distinguishing motions: in which motion two effects differ, in words."""

from __future__ import annotations

from cdia_pin.effects import Effect
from cdia_pin.identifiability.structural_rank import are_alike
from cdia_pin.robot.model import RobotModel

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
    if are_alike(robot, one, other):
        return (
            "no motion of this arm does: take off what may be the cause, such as the tool, and record again"
        )
    needs = dict.fromkeys(NEEDS.get(e.name, "position") for e in (one, other))
    return "; ".join(MOTIONS[n] for n in needs)
