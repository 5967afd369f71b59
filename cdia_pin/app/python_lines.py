"""The Python lines that repeat a session."""

from __future__ import annotations

from collections.abc import Iterator

from cdia_pin.app.history import Version
from cdia_pin.app.inputs import Request
from cdia_pin.app.session import Session
from cdia_pin.dynamics.urdf_terms import UrdfValues
from cdia_pin.regression.least_bodies import with_least_bodies

IMPORTS = {
    "parse_effect": "from cdia_pin.effects import parse_effect",
    "UrdfValues": "from cdia_pin.dynamics.urdf_terms import UrdfValues",
    "with_least_bodies": "from cdia_pin.regression.least_bodies import with_least_bodies",
    "write_report": "from cdia_pin.viewers import write_report",
}
PUBLIC = (
    "Dynamics", "add_effect", "compare", "discover", "load_model", "load_robot", "read_log", "save_model",
    "write_corrected_urdf",
)  # fmt: skip


def python_lines(session: Session) -> str:
    """Return a script that reads the same files, leads to the same model and writes what the app exports.

    Args:
        session: The session.
    """
    asked, steps = session.inputs.request, session.history.path[1:]
    body = "\n".join([*_loading(asked), *(line for v in steps for line in _adding(v)), *_writing(session)])
    used = [name for name in PUBLIC if f"{name}(" in body]
    imports = [
        f"from cdia_pin import {', '.join(used)}",
        *(line for name, line in IMPORTS.items() if name in body),
    ]
    return "\n".join([*imports, "", body, ""])


def _loading(asked: Request) -> Iterator[str]:
    options = "".join(f", {name}={value!r}" for name, value in asked.reading.items())
    yield f"robot = load_robot({asked.robot_name or asked.robot!r})"
    yield f"log = read_log({asked.name or str(asked.log)!r}, robot{options})"
    yield f"model = load_model({str(asked.model)!r}, robot)" if asked.model else "model = Dynamics(robot)"
    yield "given = compare(model, log)"


def _adding(version: Version) -> Iterator[str]:
    if version.chosen:
        yield f"found = discover(model, log)  # {', '.join(version.added)}"
    else:
        yield f"found = add_effect(model, parse_effect({version.added[0]!r}, robot), log)"
    yield "model = found.model"


def _writing(session: Session) -> Iterator[str]:
    yield "improved = compare(model, log)"
    yield "print(given.relative_rms, improved.relative_rms)  # error over torque RMS, joint by joint"
    record = ", record=found.record" if session.history.at else ""
    yield f'save_model(model, "model.json"{record})'
    model, of_unknown_mass = with_least_bodies(session.present.model)
    if UrdfValues.of(model.terms, model.robot).held:
        if of_unknown_mass:
            yield "model, _ = with_least_bodies(model)  # without masses that no motion shows"
        arguments = "**UrdfValues.of(model.terms, robot).arguments"
        yield f'write_corrected_urdf(robot, "corrected.urdf", {arguments})'
    yield 'write_report("report.html", given, improved=improved)'
