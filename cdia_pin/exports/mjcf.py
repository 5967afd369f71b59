"""A model as MJCF, MuJoCo's format: the corrected URDF's bodies, and friction, rotors, springs and gravity."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.exports.head import head
from cdia_pin.robot.inertia import at_centre_of_mass, is_physical
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf import JointKind, Urdf, UrdfJoint, urdf_of
from cdia_pin.robot.urdf_edit import add_note, text_of
from cdia_pin.robot.urdf_export import corrected_tree
from cdia_pin.robot.urdf_values import axis_of, homogeneous, welded

Array = NDArray[np.float64]

MJCF = FileFormat("an MJCF", frozenset(Quantity) - {Quantity.BREAKAWAY})
# Share of dry friction that MuJoCo's soft constraint keeps from the start [1]: slipping, a joint has its full level.
STIFF = "0.9999 0.9999 0.001 0.5 2"
LEAST = 1e-9  # [kg, kg·m²], mass and principal inertia of a moving link: MuJoCo refuses links without
THIN = 0.02  # [m], radius of the sticks that show the links
SHORTEST = 0.01  # [m], of a stick


def mjcf_text(model: Dynamics, values: SimulatorValues) -> str:
    """Return a model as MJCF: its tree of bodies without meshes and contacts, and a motor for each joint.

    Joints that do not move here are welded at their positions. Sticks stand for the links.

    Args:
        model: The model; its robot's file is read again.
        values: What `MJCF` can hold of it.

    Returns:
        Text of the file.

    Raises:
        RobotError: If a body is not physically consistent.
    """
    robot = model.robot
    urdf = _welded(robot, corrected_tree(robot, inertial=values.inertial, payload=values.payload))
    root = etree.Element("mujoco", model=robot.name)
    etree.SubElement(root, "compiler", angle="radian", autolimits="true", balanceinertia="true")
    gravity = robot.gravity_vector + (0.0 if values.gravity is None else values.gravity)
    etree.SubElement(root, "option", gravity=_numbers(gravity), integrator="implicitfast")
    etree.SubElement(etree.SubElement(root, "default"), "joint", solimpfriction=STIFF)
    world = etree.SubElement(root, "worldbody")
    base = world if urdf.root == "world" else etree.SubElement(world, "body", name=urdf.root)
    _add_links(base, urdf.root, urdf, values)
    motors = etree.SubElement(root, "actuator")
    for joint, most in zip(robot.joints, robot.limits.effort, strict=True):
        motor = etree.SubElement(motors, "motor", name=joint, joint=joint)
        if np.isfinite(most):
            motor.set("ctrlrange", _numbers([-most, most]))
    add_note(root.getroottree(), head(model, "MJCF"))
    etree.indent(root)
    return text_of(root.getroottree())


def mjcf_notes(model: Dynamics, values: SimulatorValues) -> Iterator[str]:
    """Yield what else a user of the file must know.

    Args:
        model: The model.
        values: What `MJCF` can hold of it.
    """
    robot = model.robot
    yield "The MJCF has no meshes and no contacts; sticks show the links."
    stated = zip(robot.joints, robot.urdf_damping, robot.urdf_friction, strict=True)
    only_urdf = [
        j
        for j, damping, friction in stated
        if (damping and j not in values.damping) or (friction and j not in values.friction)
    ]
    if only_urdf:
        yield f"The URDF states friction that the model does not have, so the MJCF does not: {', '.join(only_urdf)}."
    urdf = corrected_tree(robot, inertial=values.inertial, payload=values.payload)
    bodies = ((link, urdf.link_parameters(link)) for link in urdf.links)
    impossible = [link for link, pi in bodies if pi is not None and not is_physical(pi)]
    if impossible:
        yield f"No body has the URDF's inertia of {', '.join(impossible)}: MuJoCo's compiler changes it."


def _welded(robot: RobotModel, urdf: Urdf) -> Urdf:
    """Return the URDF with the joints that do not move here fixed at their positions."""
    return urdf_of(welded(urdf.tree, {name: held.position for name, held in robot.locked.items()}), urdf.path)


def _add_links(body: etree._Element, link: str, urdf: Urdf, values: SimulatorValues) -> None:
    """Add the inertia of a link to its body, a stick to each joint, and the bodies of the links beyond."""
    parameters = urdf.link_parameters(link)
    if body.tag == "body":
        _add_inertia(body, np.zeros(10) if parameters is None else parameters)
    for joint in (j for j in urdf.joints.values() if j.parent == link):
        pose = homogeneous(joint.element.find("origin"), f"joint '{joint.name}'")
        if np.linalg.norm(pose[:3, 3]) > SHORTEST:
            reach = _numbers([0.0, 0.0, 0.0, *pose[:3, 3]])
            stick = etree.SubElement(body, "geom", type="capsule", size=_numbers([THIN]), fromto=reach)
            stick.attrib.update({"contype": "0", "conaffinity": "0", "group": "1", "mass": "0"})
        child = etree.SubElement(body, "body", name=joint.child, pos=_numbers(pose[:3, 3]))
        child.set("quat", _numbers(_quaternion(pose[:3, :3])))
        if joint.is_movable:
            _add_joint(child, joint, values)
        _add_links(child, joint.child, urdf, values)


def _add_inertia(body: etree._Element, parameters: Array) -> None:
    is_moving = body.find("joint") is not None
    if parameters[0] <= 0 and not is_moving:
        return
    mass, centre, tensor = at_centre_of_mass(parameters)
    moments, axes = np.linalg.eigh(tensor)
    axes[:, 2] *= np.sign(np.linalg.det(axes))  # a rotation, not a reflection
    inertial = etree.SubElement(body, "inertial", pos=_numbers(centre), mass=repr(max(mass, LEAST)))
    inertial.set("quat", _numbers(_quaternion(axes)))
    inertial.set("diaginertia", _numbers(np.maximum(moments, LEAST)))


def _add_joint(body: etree._Element, joint: UrdfJoint, values: SimulatorValues) -> None:
    kind = "slide" if joint.kind is JointKind.PRISMATIC else "hinge"
    axis = _numbers(axis_of(joint.element, f"joint '{joint.name}'"))
    element = etree.SubElement(body, "joint", name=joint.name, type=kind, axis=axis)
    if np.isfinite([joint.lower, joint.upper]).all() and joint.lower < joint.upper:
        element.set("range", _numbers([joint.lower, joint.upper]))
    held = {"damping": values.damping, "frictionloss": values.friction, "armature": values.armature}
    for key, numbers in held.items():
        if joint.name in numbers:
            element.set(key, _numbers([numbers[joint.name]]))
    stiffness, preload = values.springs.get(joint.name, (0.0, 0.0))
    if stiffness > 0:
        element.set("stiffness", _numbers([stiffness]))
        element.set("springref", _numbers([preload / stiffness]))


def _quaternion(rotation: Array) -> Array:
    """Return a rotation as (w, x, y, z), as MuJoCo orders it, shape (4,)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat()[[3, 0, 1, 2]])


def _numbers(values: object) -> str:
    return " ".join(repr(float(v)) for v in np.asarray(values, float))
