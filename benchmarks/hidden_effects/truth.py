"""The model that lacks nothing: what the plant hides, in the package's own terms."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.arm import Arm
from benchmarks.plant.faults import VOCABULARY, Fault, mechanism
from benchmarks.plant.faults.bodies import inertia_per_mass
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.urdf import read_inertia
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import LinkInertia, Term, parse_effect
from cdia_pin.robot.inertia import parameters_of, transform_parameters

Array = NDArray[np.float64]


def true_model(plant: MujocoPlant, faults: Sequence[Fault]) -> Dynamics | None:
    """Return the arm with all that is hidden in it, or None if that is outside the vocabulary."""
    if any(f.effect not in VOCABULARY for f in faults):
        return None
    links = [f for f in faults if f.effect == "link_inertia"]
    others = [term_of(f) for f in faults if f.effect != "link_inertia"]
    return Dynamics(plant.robot, (*_links(plant, links), *others))


def label_of(fault: Fault) -> str:
    """Return the name that the package gives to a fault."""
    return parse_effect(str(fault)).label


def term_of(fault: Fault) -> Term:
    """Return a fault other than `link_inertia` as a term."""
    given = dict(fault.parameters)
    effect = parse_effect(str(fault))
    if fault.effect == "payload":
        mass, com, size = given["mass"], np.asarray(given["com"]), given["size"]
        return Term(effect, tuple(parameters_of(mass, com, mass * np.diag(inertia_per_mass(size)))))
    if fault.effect == "tool_wrench":
        return Term(effect, (*given["force"], *given["torque"]))
    shape = {p.name: given.pop(p.name) for p in effect.shape}
    return Term.of(effect.with_shape(**shape) if shape else effect, **given)


def _links(plant: MujocoPlant, faults: Sequence[Fault]) -> list[Term]:
    """Return by how much the bodies of each joint differ from the file, about the joint's frame."""
    mechanisms = [mechanism(f) for f in faults]
    arm = plant.arm(mechanisms)
    for mech in mechanisms:
        mech.present(1.0)
    true, stated = (_bodies(a) for a in (arm, MujocoPlant(plant.robot).nominal))
    out = []
    for joint in plant.joints:
        change = true[joint] - stated[joint]
        if np.abs(change).max() > 1e-12:
            out.append(Term(LinkInertia(joint), tuple(change)))
    return out


def _bodies(arm: Arm) -> dict[str, Array]:
    """Return the inertial parameters of all that moves as one with each joint, about the joint's frame."""
    data = mujoco.MjData(arm.model)
    mujoco.mj_kinematics(arm.model, data)

    def pose(body: int) -> Array:
        placed = np.eye(4)
        placed[:3, :3], placed[:3, 3] = data.xmat[body].reshape(3, 3), data.xpos[body]
        return placed

    out = {}
    for joint in arm.joints:
        from_world = np.linalg.inv(pose(arm.model.body(arm.link_of(joint)).id))
        out[joint] = sum(
            (
                transform_parameters(from_world @ pose(b)) @ parameters_of(link.mass, link.com, link.tensor)
                for b in arm.bodies_of(joint)
                for link in [read_inertia(arm.model, b)]
            ),
            start=np.zeros(10),
        )
    return out
