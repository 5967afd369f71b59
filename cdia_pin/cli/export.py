"""``cdia export``: what was found, written back into a URDF."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdia_pin.cli.console import stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import load_inputs
from cdia_pin.cli.options import Json, Robot
from cdia_pin.cli.outputs import require_writable, write_all, write_json

if TYPE_CHECKING:
    import numpy as np

    from cdia_pin.effects import Term
    from cdia_pin.robot import RobotModel

SCHEMA = "cdia-export/1"


def export(
    robot: Robot,
    model: Annotated[
        Path,
        typer.Option(
            "--model", "-m", metavar="FILE", show_default=False, help="Model with the terms to write (.json)."
        ),
    ],
    urdf: Annotated[
        Path, typer.Option("--urdf", "-u", metavar="FILE", show_default=False, help="URDF to write.")
    ],
    json: Json = None,
) -> None:
    """Write a corrected URDF: payload, link inertias, joint damping and friction.

    Says which terms of the model have no place in a URDF.
    """
    from cdia_pin.robot import write_corrected_urdf

    require_writable(urdf, json, inputs=[model])
    console = stdout(json)
    known = load_inputs(robot, model)
    if not known.terms:
        raise CommandError(f"{model} has no terms: the corrected URDF would be the one there is")
    values = UrdfValues.of(known.terms, known.robot)
    if not values.written:
        raise CommandError(f"no term of {model} has a place in a URDF: {', '.join(values.left_out)}")
    for label in values.written:
        console.print(f"in the URDF      {label}", markup=False)
    for label, why in values.left_out.items():
        console.print(f"not in the URDF  {label}: {why}", markup=False)
    if values.damping or values.friction:
        console.print("Friction in a URDF is for simulators: cdia takes it from the model, with --model.")
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "robot": known.robot.name,
        "urdf": str(urdf),
        "written": values.written,
        "left_out": values.left_out,
    }
    write_all(
        console,
        (urdf, lambda f: write_corrected_urdf(known.robot, f, **values.arguments)),
        (json, lambda f: write_json(document, f)),
    )


@dataclass
class UrdfValues:
    """What a URDF can hold of a model's terms.

    Attributes:
        inertial: Inertial parameters by joint, as ``write_corrected_urdf`` takes them.
        damping: Viscous friction by joint [N·m·s/rad or N·s/m].
        friction: Coulomb friction by joint [N·m or N].
        payload: Inertial parameters of the payload, if there is one.
        written: Labels of the terms with a place.
        left_out: Labels of the others, with the reason.
    """

    inertial: dict[str, np.ndarray] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    payload: np.ndarray | None = None
    written: list[str] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, terms: Iterable[Term], robot: RobotModel) -> UrdfValues:
        """Sort a model's terms into what a URDF can hold and what it cannot."""
        from cdia_pin.effects import ALWAYS

        out = cls()
        for term in terms:
            if term.profile != ALWAYS:
                out.left_out[term.label] = "present only at times or in a region"
            elif not out._take(term, robot):
                out.left_out[term.label] = "a URDF has no such thing"
            else:
                out.written.append(term.label)
        return out

    @property
    def arguments(self) -> dict[str, Any]:
        """What ``write_corrected_urdf`` takes."""
        return {
            "inertial": self.inertial,
            "damping": self.damping,
            "friction": self.friction,
            "payload": self.payload,
        }

    def _take(self, term: Term, robot: RobotModel) -> bool:
        import numpy as np

        from cdia_pin.effects import CoulombFriction, LinkInertia, Payload, ViscousFriction

        # A fit may end on the edge of what a body can be; a URDF must not be beyond it.
        theta = term.effect.nearest_physical(np.array(term.theta), robot)
        match term.effect:
            case ViscousFriction(joint=joint):
                self.damping[joint] = float(theta[0])
            case CoulombFriction(joint=joint):
                self.friction[joint] = float(theta[0])
            case LinkInertia(joint=joint) as body:
                self.inertial[joint] = body.total(theta, robot)
            case Payload():
                self.payload = theta
            case _:
                return False
        return True
