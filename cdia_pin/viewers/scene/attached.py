"""What acts on a whole arm, as a picture shows it: a force as an arrow at its link, a payload as a body at the tool."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import BaseTilt, ExternalWrench, Payload, Term
from cdia_pin.robot.model import RobotModel
from cdia_pin.viewers.scene.chain import chain_of
from cdia_pin.viewers.words import number, short_names

Array = NDArray[np.float64]


class PushDocument(TypedDict):
    """A force on the arm: its link by the joint that moves it, its point in that joint's frame, base axes [m, N]."""

    joint: str
    at: list[float]
    force: list[float]
    words: str


class BodyDocument(TypedDict):
    """A body that the arm carries: the joint that moves it, its centre in that joint's frame [m], its mass [kg]."""

    joint: str
    at: list[float]
    mass: float
    words: str


class AttachedDocument(TypedDict):
    """All that acts on the whole arm at a moment; ``words`` has one phrase for each."""

    push: PushDocument | None
    body: BodyDocument | None
    words: list[str]


AttachedRows = tuple[tuple[float, AttachedDocument], ...]
NOTHING: AttachedDocument = {"push": None, "body": None, "words": []}


class AttachedWords:
    """Turns believed faults into what a picture shows of the whole arm.

    Args:
        robot: The arm.
    """

    def __init__(self, robot: RobotModel) -> None:
        self._robot, self._short = robot, short_names(robot.joints)
        self._tool = robot.tool_placement
        chain = chain_of(robot)
        self._ends = {j.parent: j.placement[:3, 3] for j in reversed(chain) if j.parent is not None}
        self._ends[robot.tool_joint] = self._tool[:3, 3]

    def __call__(self, faults: Iterable[Term]) -> AttachedDocument:
        """Return what acts on the whole arm.

        Args:
            faults: Believed faults; those of joints do not count.
        """
        out: AttachedDocument = {"push": None, "body": None, "words": []}
        for term in faults:
            if isinstance(term.effect, ExternalWrench):
                out["push"] = push = self._push(term)
                out["words"].append(push["words"])
            elif isinstance(term.effect, Payload):
                out["body"] = body = self._body(term)
                out["words"].append(body["words"])
            elif isinstance(term.effect, BaseTilt):
                out["words"].append(f"base tilt {number(self._tilt(term))}°")
        return out

    def _push(self, term: Term) -> PushDocument:
        joint = term.effect.scope[0]
        force = np.array(term.theta[:3])
        words = f"force {number(float(np.linalg.norm(force)))} N on the link of {self._short[joint]}"
        return {"joint": joint, "at": _rounded(self._ends[joint]), "force": _rounded(force), "words": words}

    def _body(self, term: Term) -> BodyDocument:
        mass, moment = float(term.theta[0]), np.array(term.theta[1:4])
        centre = np.append(moment / mass if mass else np.zeros(3), 1.0)
        at = (self._tool @ centre)[:3]
        words = f"payload {number(mass)} kg"
        return {"joint": self._robot.tool_joint, "at": _rounded(at), "mass": round(mass, 4), "words": words}

    def _tilt(self, term: Term) -> float:
        """Return the angle between gravity and where the URDF has it [°]."""
        across = float(np.linalg.norm(term.theta)) / float(np.linalg.norm(self._robot.gravity_vector))
        return float(np.degrees(np.arcsin(min(across, 1.0))))


def attached_rows(beliefs: Sequence[tuple[float, Sequence[Term]]], robot: RobotModel) -> AttachedRows:
    """Return what acts on the whole arm over time, each from its time [s] on.

    Args:
        beliefs: Times [s] with the faults that are believed from then on.
        robot: The arm.
    """
    document_of = AttachedWords(robot)
    rows: list[tuple[float, AttachedDocument]] = []
    for time, faults in beliefs:
        now = document_of(faults)
        if now != (rows[-1][1] if rows else NOTHING):
            rows.append((round(time, 3), now))
    return tuple(rows)


def _rounded(x: Array) -> list[float]:
    return [round(float(v), 4) for v in x]
