"""A payload for the controller of a UR: mass, centre of gravity and inertia, as a line of URScript."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.errors import ModelError
from cdia_pin.exports.head import head
from cdia_pin.phrases import printable
from cdia_pin.robot.inertia import at_centre_of_mass, is_physical, transform_parameters
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

UR_PAYLOAD = FileFormat("the payload of a controller", frozenset({Quantity.PAYLOAD}))
FLANGE = "tool0"  # frame of the flange in the URDFs of UR, with the controller's axes
LARGEST = 133.0  # [kg·m²], inertia above which the controller refuses a payload


def ur_payload_text(model: Dynamics, values: SimulatorValues) -> str:
    """Return the line ``set_target_payload`` with mass, centre of gravity, and inertia where a body can have it.

    The centre of gravity is in the frame ``tool0`` of the URDF, which is the controller's flange; without one, in the
    tool frame.

    Args:
        model: The model.
        values: What `UR_PAYLOAD` can hold of it.

    Raises:
        ModelError: If the model has no payload, or one without a mass above zero.
    """
    if values.payload is None:
        raise ModelError("the model has no payload")
    frame, to_frame = _flange(model.robot)
    payload = transform_parameters(to_frame) @ values.payload
    if payload[0] <= 0:
        raise ModelError(
            f"the payload has a mass of {payload[0]:.4g} kg: the arm lacks a tool that its URDF has, and a controller "
            "cannot be told so"
        )
    mass, centre, tensor = at_centre_of_mass(payload)
    arguments = [_text(mass), _list(centre)]
    said = f"Centre of gravity [m] in the frame {printable(frame)}"
    if is_physical(payload) and np.abs(tensor).max() <= LARGEST:
        arguments.append(_list(tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]))
        said += "; inertia [kg·m²] about it as xx, yy, zz, xy, xz, yz, along the axes of this frame"
    else:
        said += "; no inertia, because no body has the one that was fitted"
    return f"""# {head(model, "Payload")}
# {said}.
# It comes on top of what the URDF carries at the tool.
set_target_payload({", ".join(arguments)})
"""


def _flange(robot: RobotModel) -> tuple[str, Array]:
    """Return the controller's frame, and the pose of the tool frame in it, homogeneous [1, m], shape (4, 4)."""
    joint, pose = robot.links.get(FLANGE, (None, np.eye(4)))
    if joint != robot.tool_joint:
        return robot.tool_frame, np.eye(4)
    return FLANGE, np.asarray(np.linalg.solve(pose, robot.tool_placement))


def _list(values: Array) -> str:
    return f"[{', '.join(map(_text, values))}]"


def _text(value: float) -> str:
    return f"{value:.6f}" if abs(value) >= 5e-7 else "0"
