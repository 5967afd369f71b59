"""Every parameter of a model with its 95 % interval, as bounds for domain randomisation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NotRequired, TypedDict

import numpy as np

from cdia_pin import schemas
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import LinkInertia, Term
from cdia_pin.robot.model import RobotModel


class RangeRecord(TypedDict):
    """The range of one parameter.

    Attributes:
        effect: Name of the effect.
        joints: Its joints; none for an effect of the whole arm.
        parameter: Name of the parameter.
        unit: Its unit, also that of all numbers here.
        base: The URDF's value; 0 where a URDF has none.
        value: The model's value; for a link's inertia the whole one, that of the URDF and the difference.
        lower: Lower end of the 95 % interval; left out where nobody estimated one.
        upper: Upper end.
        shape: The effect's shape parameters, where it has any; they have no interval.
        profile: Where the effect is present, unless it always is.
    """

    effect: str
    joints: list[str]
    parameter: str
    unit: str
    base: float
    value: float
    lower: NotRequired[float]
    upper: NotRequired[float]
    shape: NotRequired[dict[str, object]]
    profile: NotRequired[dict[str, object]]


class RangesDocument(TypedDict):
    """Ranges of all parameters of a model, schema ``cdia-ranges/1``.

    Attributes:
        schema: Name of the schema.
        robot: Name of the robot.
        joints: Names of its joints.
        parameters: Ranges, in the order of the model's terms.
    """

    schema: str
    robot: str
    joints: list[str]
    parameters: list[RangeRecord]


def ranges_document(model: Dynamics) -> RangesDocument:
    """Return the range of every parameter of a model, no wider than its physical bounds.

    Args:
        model: The model.
    """
    return {
        "schema": schemas.RANGES,
        "robot": model.robot.name,
        "joints": list(model.robot.joints),
        "parameters": [record for term in model.terms for record in _records(term, model.robot)],
    }


def _records(term: Term, robot: RobotModel) -> Iterator[RangeRecord]:
    effect, base = term.effect, _base(term, robot)
    lower, upper = effect.bounds(robot)
    known = effect.to_dict()
    for i, parameter in enumerate(effect.parameters):
        record: RangeRecord = {
            "effect": known["effect"],
            "joints": list(known["joints"]),
            "parameter": parameter.name,
            "unit": effect.units(robot)[i],
            "base": float(base[i]),
            "value": float(base[i] + term.theta[i]),
        }
        if term.ci95 is not None:
            least, most = np.clip(term.ci95[i], lower[i], upper[i]) + base[i]
            record["lower"], record["upper"] = float(least), float(most)
        if shape := known.get("shape"):
            record["shape"] = shape
        if (profile := term.profile.to_dict())["kind"] != "always":
            record["profile"] = profile
        yield record


def _base(term: Term, robot: RobotModel) -> list[float]:
    """Return the URDF's value of each parameter, shape (p,): only inertias are differences to it."""
    bodies = term.effect.bodies
    if not bodies or not all(isinstance(body, LinkInertia) for body in bodies):
        return [0.0] * term.effect.size
    return [float(v) for body in bodies for v in robot.inertial_parameters[body.carrier(robot)]]
