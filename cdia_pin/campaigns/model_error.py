"""Errors of a model's inertias, as every model of a real arm has them."""

from __future__ import annotations

import numpy as np

from cdia_pin.errors import RobotError
from cdia_pin.robot.inertia import at_centre_of_mass, parameters_of
from cdia_pin.robot.model import RobotModel


def with_model_error(robot: RobotModel, size: float, rng: np.random.Generator) -> RobotModel:
    """Return an arm whose inertias differ from those of the file and are physically consistent.

    The mass and the tensor about the centre of mass of each body are multiplied by random factors within 1 ± size.
    The centre of mass moves in a random direction by up to ``size`` of its distance from the joint.

    Args:
        robot: The arm of the file.
        size: Largest relative error [1].
        rng: Source of the errors.

    Returns:
        A new arm; the given one is not changed.

    Raises:
        RobotError: If the size is not between 0 and 0.5.
    """
    if not 0 <= size <= 0.5:
        raise RobotError(f"a model error must be between 0 and 0.5, given {size}")
    bodies = []
    for body in robot.inertial_parameters:
        heavier, further, wider = rng.uniform(-size, size, 3)
        direction = rng.standard_normal(3)
        direction /= np.linalg.norm(direction)
        mass, centre, tensor = at_centre_of_mass(body)
        moved = centre + further * np.linalg.norm(centre) * direction
        bodies.append(parameters_of(mass * (1 + heavier), moved, tensor * (1 + wider)))
    return robot.with_inertial_parameters(np.array(bodies))
