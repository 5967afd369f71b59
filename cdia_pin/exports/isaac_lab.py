"""Actuator settings of a model for Isaac Lab, as lines of Python."""

from __future__ import annotations

import re

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.exports.head import head
from cdia_pin.exports.joint_settings import BODIES_ELSEWHERE, for_every_joint

ISAAC_LAB = FileFormat(
    "an actuator of Isaac Lab",
    frozenset({Quantity.DAMPING, Quantity.FRICTION, Quantity.BREAKAWAY, Quantity.ARMATURE}),
    BODIES_ELSEWHERE,
)


def isaac_lab_text(model: Dynamics, values: SimulatorValues) -> str:
    """Return a module with ``ACTUATORS`` for an `ArticulationCfg`: armature, friction at rest and in motion, limits.

    Viscous friction is the joint's ``viscous_friction``; ``damping`` is a gain of the drive, and stays its user's.

    Args:
        model: The model.
        values: What `ISAAC_LAB` can hold of it.
    """
    joints = model.robot.joints
    armature, moving, breakaway, viscous = (
        for_every_joint(numbers, model.robot)
        for numbers in (values.armature, values.friction, values.breakaway, values.damping)
    )
    limits = {
        j: float(most) for j, most in zip(joints, model.robot.limits.effort, strict=True) if np.isfinite(most)
    }
    settings = {
        "effort_limit_sim": (limits, "N·m or N; joint_effort_limit from Isaac Lab 3 on"),
        "armature": (armature, "kg·m² or kg"),
        "friction": ({j: moving[j] + breakaway[j] for j in joints}, "N·m or N, at rest"),
        "dynamic_friction": (moving, "N·m or N, in motion"),
        "viscous_friction": (viscous, "N·m·s/rad or N·s/m"),
    }
    names = "".join(f"            {re.escape(j)!r},\n" for j in joints)
    blocks = "".join(_block(key, numbers, unit) for key, (numbers, unit) in settings.items() if numbers)
    return f'''# {head(model, "Isaac Lab's actuator settings")}
"""ACTUATORS for an ArticulationCfg, with Isaac Sim 5.0 or newer, where friction is a torque and no coefficient."""

from isaaclab.actuators import ImplicitActuatorCfg

ACTUATORS = {{
    "arm": ImplicitActuatorCfg(
        joint_names_expr=[
{names}        ],
        stiffness=None,  # gains of the drive: yours, or those of the USD file
        damping=None,
{blocks}    ),
}}
'''


def _block(key: str, numbers: dict[str, float], unit: str) -> str:
    rows = "".join(f"            {re.escape(joint)!r}: {number!r},\n" for joint, number in numbers.items())
    return f"        {key}={{  # [{unit}]\n{rows}        }},\n"
