"""The files that a session exports, as bytes: model, corrected URDF, report and Python lines."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

from cdia_pin.app.python_lines import python_lines
from cdia_pin.app.session import Session
from cdia_pin.dynamics import save_model
from cdia_pin.errors import ModelError
from cdia_pin.exports.formats import FORMATS
from cdia_pin.regression.least_bodies import with_least_bodies
from cdia_pin.viewers import write_report


def model_file(session: Session) -> bytes:
    """Return the present model as `save_model` writes it.

    Args:
        session: The session.
    """
    fitted = session.present.fitted
    record = fitted.record if fitted else session.present.comparison.record
    return written("model.json", lambda path: save_model(session.present.model, path, record=record))


def urdf_file(session: Session) -> bytes:
    """Return the URDF with what it can hold of the present model, without masses that no motion shows.

    Relative mesh paths hold from the folder of the robot's own URDF.

    Raises:
        ModelError: If the model has no term with a place in a URDF.
    """
    (model, _), urdf = with_least_bodies(session.present.model), FORMATS["urdf"]
    values = urdf.values(model)
    if not values.held:
        have = ", ".join(values.left_out) or "no terms"
        raise ModelError(f"nothing of the model has a place in a URDF; it has {have}")
    return urdf.text(model, values, model.robot.urdf.parent).encode()


def report_file(session: Session) -> bytes:
    """Return the report on the present model beside the model as given.

    Args:
        session: The session.
    """
    first, present, inputs = session.history.first, session.present, session.inputs
    improved = None if present is first else present.comparison
    return written(
        "report.html",
        lambda path: write_report(
            path,
            first.comparison,
            improved=improved,
            discovery=session.history.discovery,
            checks=[inputs.check],
            command="",
        ),
    )


def python_file(session: Session) -> bytes:
    """Return the Python lines that lead to the same model.

    Args:
        session: The session.
    """
    return python_lines(session).encode()


def written(name: str, write: Callable[[Path], object]) -> bytes:
    """Return the bytes that a function writes to a file.

    Args:
        name: Of the file.
        write: Called with a path of this name.
    """
    with tempfile.TemporaryDirectory(prefix="cdia-") as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()
