"""Model files: JSON that people can read, compare and edit."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NotRequired, TypedDict

from cdia_pin import schemas
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.errors import CdiaError, ModelError
from cdia_pin.input_files import read_text
from cdia_pin.logs.motion_file import MotionDocument, motion_document, motion_from
from cdia_pin.phrases import shortened
from cdia_pin.robot import catalogue
from cdia_pin.robot.model import RobotModel
from cdia_pin.version import __version__
from cdia_pin.whole_files import write_whole

BY_HAND = str.maketrans({"*": "·", "⋅": "·", "²": "2", "³": "3", " ": None})  # other ways to write a unit


class ModelDocument(TypedDict):
    """A model file, schema ``cdia-model/1``.

    Attributes:
        schema: Name of the schema.
        version: Version of the package that wrote the file.
        robot: Name of the robot.
        joints: Names of its joints.
        terms: Records of the terms.
        record: Origin of the numbers: logs, hashes, settings.
        learned_from: Conditioned logs that the terms were fitted to, so that a later log can be compared with them.
    """

    schema: str
    version: str
    robot: str
    joints: list[str]
    terms: Sequence[Mapping[str, object]]
    record: Mapping[str, object]
    learned_from: NotRequired[list[MotionDocument]]


def save_model(model: Dynamics, path: str | Path, *, record: Mapping[str, Any] | None = None) -> Path:
    """Write a model.

    Args:
        model: Its terms and the name of its robot are written.
        path: File to write.
        record: Origin of the numbers: logs, hashes, settings; plain JSON.

    Returns:
        The path that was written.

    Raises:
        ModelError: If the record is not plain JSON, or the file cannot be written.
    """
    path = Path(path)
    document = model_document(model, record)
    if model.learned_from:
        document["learned_from"] = [motion_document(m) for m in model.learned_from]
    try:
        text = json.dumps(document, indent=2, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise ModelError(f"the record of a model must be plain JSON: {error}") from None
    try:
        write_whole(path, text + "\n")
    except OSError as error:
        raise ModelError(f"cannot write the model to {path}: {error.strerror}") from None
    return path


def load_model(path: str | Path, robot: RobotModel) -> Dynamics:
    """Read a model that `save_model` wrote.

    Args:
        path: The file.
        robot: The robot of the model.

    Returns:
        The model.

    Raises:
        ModelError: If the file is not a model, or belongs to another robot.
    """
    path = Path(path)
    try:
        document = json.loads(read_text(path))
    except OSError as error:
        raise ModelError(f"cannot read the model {path}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise ModelError(f"{path} is not a model: {error}") from None
    if not isinstance(document, dict) or document.get("schema") != schemas.MODEL:
        raise ModelError(f'{path} is not a model: expected a JSON object with "schema": "{schemas.MODEL}"')
    return model_from_document(document, path, robot)


def model_document(model: Dynamics, record: Mapping[str, Any] | None = None) -> ModelDocument:
    """Return a model as its file has it, without the logs that it was learned from.

    Args:
        model: Its terms and the name of its robot are kept.
        record: Origin of the numbers; plain JSON.
    """
    return {
        "schema": schemas.MODEL,
        "version": __version__,
        "robot": model.robot.name,
        "joints": list(model.robot.joints),
        "terms": [t.to_dict(model.robot) for t in model.terms],
        "record": record or {},
    }


def model_from_document(document: Mapping[str, Any], path: Path, robot: RobotModel) -> Dynamics:
    """Return the model of a document.

    Args:
        document: As `model_document` returns it, with or without the logs.
        path: Where it comes from, for messages.
        robot: The robot of the model.

    Raises:
        ModelError: If it is not valid, or belongs to another robot.
    """
    _require_same_robot(document, path, robot)
    try:
        terms = tuple(Term.from_dict(t) for t in document["terms"])
        model = Dynamics(robot, terms, tuple(motion_from(m) for m in document.get("learned_from", [])))
        for term, record in zip(terms, document["terms"], strict=True):
            _require_units(term, record.get("parameters", {}), robot)
        return model
    except CdiaError as error:
        raise ModelError(f"{path}: {error}") from None
    except (KeyError, TypeError, AttributeError, ValueError, IndexError, OverflowError) as error:
        raise ModelError(f"{path}: a term is not valid: {_why(error)}") from None


def _why(error: Exception) -> str:
    """Return what is wrong with a term: a key that is missing, or its form."""
    missing = isinstance(error, KeyError) and error.args
    return (
        f"'{error.args[0]}' is missing"
        if missing
        else "a number, a list or an object is not where it should be"
    )


def _require_units(term: Term, written: Mapping[str, Any], robot: RobotModel) -> None:
    """Refuse a parameter in another unit than the effect's: nothing converts it. No unit means the effect's."""
    for parameter, unit in zip(term.effect.parameters, term.effect.units(robot), strict=True):
        record = written[parameter.name]
        given = record.get("unit", unit) if isinstance(record, Mapping) else unit
        if str(given).translate(BY_HAND).replace("^", "") != unit.translate(BY_HAND):
            raise ModelError(
                f"{term.label}: {parameter.name} is in {unit}, given in {shortened(str(given))}; "
                f"write the number in {unit}"
            )


def _require_same_robot(document: Mapping[str, Any], path: Path, robot: RobotModel) -> None:
    """Refuse other joints, and another robot of the catalogue whose joints have the same names."""
    name, joints = str(document.get("robot")), document.get("joints")
    if joints != list(robot.joints):
        given = ", ".join(map(str, joints)) if isinstance(joints, list) else repr(joints)
        raise ModelError(
            f"{path} was made for the joints {given} of '{name}', "
            f"the robot '{robot.name}' has {', '.join(robot.joints)}"
        )
    if name != robot.name and {name, robot.name} <= set(catalogue()):
        raise ModelError(f"{path} was made for '{name}', the robot is '{robot.name}'")
