"""The repr of every public object is one short line that names it."""

from pathlib import Path

import pytest

import cdia_pin.robot as room
from cdia_pin.robot import JointLimits, LockedJoint, RobotModel, catalogue, load_robot
from cdia_pin.robot.collision import CollisionModel
from cdia_pin.robot.urdf import read_urdf


def examples() -> list[object]:
    ur5, long_path = load_robot("ur5"), Path("/" + "folder/" * 40 + "arm.urdf")
    renamed = RobotModel(ur5.pinocchio_model, name="a long name " * 30, urdf=long_path)
    shapes = CollisionModel(load_robot("scara"))
    entry = catalogue()["ur5"]
    return [ur5, renamed, ur5.limits, LockedJoint(0.0, "asked for"), entry, shapes, read_urdf(ur5.urdf)]


@pytest.mark.parametrize("shown", examples(), ids=lambda x: type(x).__name__)
def test_a_repr_is_one_short_line_that_names_the_object(shown):
    text = repr(shown)
    assert text.startswith(type(shown).__name__ + "(")
    assert "\n" not in text
    assert len(text) < 200


def test_every_public_class_of_the_folder_has_an_example():
    public = {x for x in vars(room).values() if isinstance(x, type)}
    assert public <= {type(x) for x in examples()}
    assert JointLimits in public


def test_the_repr_of_a_robot_tells_its_name_and_number_of_joints():
    assert repr(load_robot("ur5")) == "RobotModel('ur5', 6 joints, tool frame 'tool0')"
