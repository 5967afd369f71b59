"""An arm touches itself and the floor where its shapes do, and nowhere else."""

import numpy as np
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.robot import load_robot
from cdia_pin.robot.collision import FLOOR, CollisionModel, standing_height

UPRIGHT = np.array([0.0, -np.pi / 2, 0.0, -np.pi / 2, 0.0, 0.0])  # of a UR: straight up


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def ur5_shapes(ur5):
    return CollisionModel(ur5)


def postures(robot, count, seed=0):
    lower, upper = np.maximum(robot.limits.lower, -2.0), np.minimum(robot.limits.upper, 2.0)
    return np.random.default_rng(seed).uniform(lower, upper, (count, robot.n))


def links(contact):
    return {name.rpartition("_")[0] for name in contact.shapes}


def test_an_arm_that_points_up_touches_nothing(ur5_shapes):
    assert ur5_shapes.first_contact(UPRIGHT) is None


def test_a_folded_elbow_puts_the_wrist_into_the_arm(ur5_shapes):
    folded = UPRIGHT + np.array([0, 0, 3.0, 0, 0, 0])
    contact = ur5_shapes.first_contact(folded)
    assert links(contact) & {"wrist_1_link", "wrist_2_link", "forearm_link", "wrist_3_link", "ee_link"}
    assert links(contact) & {"shoulder_link", "upper_arm_link", "base_link"}


def test_the_first_posture_with_a_contact_is_returned(ur5_shapes):
    folded = UPRIGHT + np.array([0, 0, 3.0, 0, 0, 0])
    assert ur5_shapes.first_contact(np.array([UPRIGHT, UPRIGHT, folded, folded])).sample == 2


def test_neighbours_are_not_paired(ur5_shapes):
    pairs = [{name.rpartition("_")[0] for name in pair} for pair in ur5_shapes.pairs]
    assert {"upper_arm_link", "forearm_link"} not in pairs
    assert {"upper_arm_link", "wrist_1_link"} in pairs


def test_shapes_that_always_overlap_are_left_out():
    scara = CollisionModel(load_robot("scara"))
    assert scara.left_out == (("link2_0", "quill_0"),)
    assert scara.left_out[0] not in scara.pairs


def test_pairs_that_an_srdf_disables_are_left_out(ur5, tmp_path):
    file = tmp_path / "ur5.srdf"
    file.write_text(
        '<robot name="ur5"><disable_collisions link1="wrist_1_link" link2="wrist_3_link" reason="Never"/></robot>',
        encoding="utf-8",
    )
    all_pairs, fewer = CollisionModel(ur5).pairs, CollisionModel(ur5, srdf=file).pairs
    assert set(all_pairs) - set(fewer) == {("wrist_1_link_0", "wrist_3_link_0")}
    with pytest.raises(RobotError, match="no such SRDF"):
        CollisionModel(ur5, srdf=tmp_path / "none.srdf")
    file.write_text("<robot", encoding="utf-8")
    with pytest.raises(RobotError, match="cannot read"):
        CollisionModel(ur5, srdf=file)


def test_near_shapes_touch_with_a_larger_clearance(ur5):
    free = {c: set() for c in (0.0, 0.02, 0.1)}
    for clearance, kept in free.items():
        shapes = CollisionModel(ur5, clearance=clearance)
        kept |= {k for k, q in enumerate(postures(ur5, 150)) if shapes.first_contact(q) is None}
    assert free[0.1] < free[0.02] <= free[0.0]


def test_a_floor_is_touched_from_above_only(ur5):
    down = np.array([0.0, np.pi / 4, 0.0, 0.0, 0.0, 0.0])  # stretched, and below its base
    assert CollisionModel(ur5).first_contact(down) is None
    assert FLOOR in CollisionModel(ur5, floor=0.0).first_contact(down).shapes
    assert CollisionModel(ur5, floor=-2.0).first_contact(down) is None


def test_the_floor_is_perpendicular_to_gravity():
    wall = load_robot("ur5", gravity=(9.81, 0.0, 0.0))  # on a wall: x points down, and a floor is 0.3 m below
    shapes = CollisionModel(wall, floor=-0.3)
    for turned, touches in ((0.0, True), (np.pi, False)):
        q = np.array([turned, 0.0, 0.0, 0.0, 0.0, 0.0])
        below = wall.joint_placements(q)[-1, 0, 3]
        assert (below > 0.5, below < -0.5) == (touches, not touches)
        contact = shapes.first_contact(q)
        assert (contact is not None and FLOOR in contact.shapes) == touches


@pytest.mark.parametrize(("name", "height"), [("ur5", 0.0), ("panda", 0.0), ("baxter_left_arm", -0.92)])
def test_an_arm_stands_on_the_lowest_point_of_its_fixed_shapes(name, height):
    assert standing_height(load_robot(name)) == pytest.approx(height, abs=0.01)


def test_an_arm_without_shapes_touches_nothing():
    robot = load_robot("asr_twodof")
    shapes = CollisionModel(robot)
    assert shapes.pairs == ()
    assert shapes.first_contact(postures(robot, 20)) is None
    assert standing_height(robot) is None


def test_continuous_joints_are_placed_by_their_angle(ur5):
    kinova = load_robot("kinova")
    assert kinova.is_continuous.any()
    q = postures(kinova, 20)
    shapes = CollisionModel(kinova)
    turned = q + 2 * np.pi * kinova.is_continuous
    same = [shapes.first_contact(x) == shapes.first_contact(y) for x, y in zip(q, turned, strict=True)]
    assert all(same)


def test_a_negative_clearance_is_refused(ur5):
    with pytest.raises(RobotError, match="clearance"):
        CollisionModel(ur5, clearance=-0.1)
