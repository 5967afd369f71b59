"""Joint and actuator settings of a model for Drake, as lines of Python."""

from __future__ import annotations

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.exports.head import head
from cdia_pin.exports.joint_settings import BODIES_ELSEWHERE, for_every_joint

DRAKE = FileFormat(
    "a joint of Drake",
    frozenset({Quantity.DAMPING, Quantity.ARMATURE}),
    BODIES_ELSEWHERE,
)


def drake_text(model: Dynamics, values: SimulatorValues) -> str:
    """Return a module whose function `apply` sets damping and rotor inertia of a `MultibodyPlant`.

    The rotor inertia is that seen at the joint, so the gear ratio is 1.

    Args:
        model: The model.
        values: What `DRAKE` can hold of it.
    """
    return f'''# {head(model, "Drake's joint and actuator settings")}
"""Settings for a plant that has read the arm's URDF; apply(plant) comes before plant.Finalize()."""

import math

# joint: viscous friction, default_damping [N·m·s/rad or N·s/m]
DAMPING = {{
{_rows(model, values.damping)}}}
# joint: inertia of rotor and gear as the joint sees it [kg·m² or kg]
ROTOR_INERTIA = {{
{_rows(model, values.armature)}}}


def apply(plant):
    """Set damping and rotor inertia; a joint without an actuator gets one."""
    actuators = {{}}
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        actuators[actuator.joint().name()] = actuator
    for name, damping in DAMPING.items():
        plant.GetJointByName(name).set_default_damping(damping)
    for name, inertia in ROTOR_INERTIA.items():
        if name not in actuators:
            joint = plant.GetJointByName(name)
            actuators[name] = plant.AddJointActuator(name, joint, math.inf)
        actuators[name].set_default_rotor_inertia(inertia)
        actuators[name].set_default_gear_ratio(1.0)
'''


def _rows(model: Dynamics, numbers: dict[str, float]) -> str:
    return "".join(
        f"    {joint!r}: {number!r},\n" for joint, number in for_every_joint(numbers, model.robot).items()
    )
