"""Robots by name and by file: what moves, what is held and why, and errors a person can act on."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.robot import catalogue, load_robot
from cdia_pin.robot.catalogue import example_robots_dir, joints_here, robots_here

INERTIAL = (
    '<inertial><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def link(name: str, m: float | str = 1.0, i: float = 0.1, izz: float = 0.1) -> str:
    return f'<link name="{name}">{INERTIAL.format(m=m, i=i, izz=izz)}</link>'


def joint(
    name: str, parent: str, child: str, kind: str = "revolute", extra: str = "", lower=-2, upper=2
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/><axis xyz="0 1 0"/>'
        f'<limit lower="{lower}" upper="{upper}" effort="10" velocity="2"/>{extra}</joint>'
    )


@pytest.fixture
def urdf(tmp_path):
    def write(*parts: str, text: str | None = None) -> Path:
        path = tmp_path / "my_arm.urdf"
        path.write_text(text if text is not None else f'<robot name="my_arm">{"".join(parts)}</robot>')
        return path

    return write


# ------------------------------------------------------------------ the catalogue


@pytest.mark.parametrize(
    "name", [name for name, entry in catalogue().items() if entry.source != "robot_descriptions"]
)
def test_every_robot_of_the_catalogue_is_a_sound_chain(name):
    robot = load_robot(name)
    entry = catalogue()[name]
    assert robot.warnings == ()
    assert robot.tool_frame == entry.tool_frame
    assert robot.tool_joint == robot.joints[-1]
    assert robot.limits.velocity.max() < np.inf
    assert entry.description and entry.licence and entry.origin
    assert all(held.reason for held in robot.locked.values())


def test_joints_are_known_without_a_model():
    assert dict(joints_here()) == {robot.name: frozenset(robot.joints) for robot in robots_here()}


def test_ur3_is_not_a_ur5():
    assert load_robot("ur3").total_mass < 0.6 * load_robot("ur5").total_mass


def test_fingers_wheels_and_torso_are_locked_by_name():
    tiago = load_robot("tiago")
    assert tiago.joints == tuple(f"arm_{i}_joint" for i in range(1, 8))
    assert tiago.locked["wheel_left_joint"].reason == "wheel"
    assert tiago.locked["torso_lift_joint"].position == 0.0
    assert load_robot("panda").joints == tuple(f"panda_joint{i}" for i in range(1, 8))


def test_a_link_and_a_joint_of_one_name_do_not_confuse_the_tool():
    so100 = load_robot("so100")  # link 'gripper', joint 'gripper'
    assert so100.tool_joint == "wrist_roll"
    assert "gripper" in so100.locked


def test_meshes_of_packages_resolve():
    panda = load_robot("panda")
    mesh = "example-robot-data/robots/panda_description/meshes"
    assert any((folder / mesh).is_dir() for folder in panda.package_dirs)


@pytest.mark.parametrize(
    "kinds", [{"tiago": "torso_lift_joint"}, {"tiago": "arm_3_joint", "kinova": "j2s6s200_joint_4"}]
)
def test_locked_joints_weigh_at_their_locked_position(kinds):
    for name, held in kinds.items():
        robot = load_robot(name, lock={held: 0.7})
        full = pin.buildModelFromUrdf(str(robot.urdf))
        q = pin.neutral(full)
        at = full.joints[full.getJointId(held)]
        q[at.idx_q : at.idx_q + at.nq] = [0.7] if at.nq == 1 else [np.cos(0.7), np.sin(0.7)]
        reduced = pin.buildReducedModel(full, [full.getJointId(j) for j in robot.locked], q)
        expected = [inertia.toDynamicParameters() for inertia in list(reduced.inertias)[1:]]
        assert tuple(reduced.names[1:]) == robot.joints
        np.testing.assert_allclose(robot.inertial_parameters, expected, atol=1e-12)


def test_gravity_can_be_given_as_size_or_vector():
    np.testing.assert_array_equal(load_robot("ur5", gravity=1.62).gravity_vector, [0, 0, -1.62])
    np.testing.assert_array_equal(load_robot("ur5", gravity=[0, 9.8, 0]).gravity_vector, [0, 9.8, 0])
    with pytest.raises(RobotError, match="vector of three"):
        load_robot("ur5", gravity=[1.0, 2.0])


def test_an_unknown_name_is_refused_with_the_nearest_ones():
    with pytest.raises(RobotError, match=r"unknown robot 'pnda'; did you mean panda"):
        load_robot("pnda")


def test_an_unknown_tool_frame_is_refused_with_the_nearest_ones():
    with pytest.raises(RobotError, match=r"tool frame 'tol0'.*tool0"):
        load_robot("ur5", tool_frame="tol0")


# ------------------------------------------------------------------ a user's own file


def test_mimic_joints_are_locked_at_their_leaders_position(urdf):
    follows = '<mimic joint="slide" multiplier="-2" offset="0.1"/>'
    path = urdf(
        *[link(name) for name in ("base", "a", "b", "c")],
        joint("shoulder", "base", "a"),
        joint("slide", "a", "b"),
        joint("copy", "a", "c", extra=follows),
    )
    robot = load_robot(path, lock={"slide": 0.3})
    assert robot.joints == ("shoulder",)
    assert robot.locked["copy"].position == pytest.approx(-0.5)
    assert robot.locked["copy"].reason == "mimics slide"
    assert robot.locked["slide"].reason == "asked for"


def test_a_mimic_joint_of_a_moving_leader_gives_a_warning(urdf):
    path = urdf(
        *[link(name) for name in ("base", "a", "b")],
        joint("shoulder", "base", "a"),
        joint("rod", "base", "b", extra='<mimic joint="shoulder"/>'),
    )
    robot = load_robot(path)
    assert robot.joints == ("shoulder",)
    assert any("'rod' mimics the moving joint 'shoulder'" in w for w in robot.warnings)
    with pytest.raises(RobotError, match="no torque of its own"):
        load_robot(path, keep=["rod"])


def test_joints_named_like_fingers_are_locked_unless_kept(urdf):
    path = urdf(
        *[link(name) for name in ("base", "a", "b", "c")],
        joint("shoulder", "base", "a"),
        joint("Left_Finger", "a", "b", lower=0.2, upper=0.5),
        joint("right_finger", "a", "c", kind="prismatic"),
    )
    robot = load_robot(path)
    assert robot.joints == ("shoulder",)
    assert robot.locked["Left_Finger"].reason == "its name contains 'finger'"
    assert robot.locked["Left_Finger"].position == 0.2  # zero is out of its range
    assert load_robot(path, keep=["right_finger"]).joints == ("shoulder", "right_finger")


def test_a_wrist_that_carries_an_arm_is_not_a_finger(urdf):
    path = urdf(
        *[link(name) for name in ("base", "a", "b")],
        joint("gripper_yaw", "base", "a"),
        joint("wrist", "a", "b"),
    )
    assert load_robot(path).joints == ("gripper_yaw", "wrist")


def test_two_arms_are_refused_with_the_lock_that_keeps_one(urdf):
    path = urdf(
        *[link(name) for name in ("base", "l1", "l2", "r1", "r2", "h")],
        joint("left_1", "base", "l1"),
        joint("left_2", "l1", "l2"),
        joint("right_1", "base", "r1"),
        joint("right_2", "r1", "r2"),
        joint("head", "base", "h"),
    )
    with pytest.raises(RobotError) as error:
        load_robot(path)
    message = str(error.value)
    assert "at the base" in message and "\n" not in message
    assert "--lock 'right_*,head' --save arm.urdf" in message
    assert "lock=['right_*', 'head']" in message
    assert load_robot(path, lock=["right_*", "head"]).joints == ("left_1", "left_2")


@pytest.mark.parametrize(
    ("bones", "kept", "lock"), [(1, "yaw..pitch", "index_*,ring_*,head"), (3, "yaw..index_3", "ring_*,head")]
)
def test_an_arm_ends_where_short_branches_fork(urdf, bones, kept, lock):
    above = {"yaw": "base", "pitch": "yaw", "head": "base"}
    for digit in ("index", "ring"):
        chain = ["pitch", *(f"{digit}_{k}" for k in range(1, bones + 1))]
        above |= dict(pairwise(reversed(chain)))
    path = urdf(link("base"), *map(link, above), *(joint(n, parent, n) for n, parent in above.items()))
    with pytest.raises(RobotError) as error:
        load_robot(path)
    assert f"to keep {kept}, lock" in str(error.value)
    assert f"--lock '{lock}' --save" in str(error.value)


def test_a_real_robot_with_two_arms_is_refused_with_the_joints_to_lock():
    path = catalogue()["baxter_left_arm"].path
    with pytest.raises(RobotError, match=r"branches at the base.*left_s0\.\.left_w2") as error:
        load_robot(path)
    lock = str(error.value).split("lock=[")[1].split("]")[0]
    assert load_robot(path, lock=[n.strip(" '[]") for n in lock.split(",")]).n == 7


def test_a_continuous_joint_has_one_coordinate(urdf):
    path = urdf(
        *[link(n) for n in ("base", "a", "b")], joint("j1", "base", "a", "continuous"), joint("j2", "a", "b")
    )
    robot = load_robot(path)
    np.testing.assert_array_equal(robot.is_continuous, [True, False])
    assert robot.mass_matrix(np.zeros(2)).shape == (2, 2)


def test_unphysical_and_missing_inertias_give_warnings(urdf):
    path = urdf(
        link("base"),
        link("a", izz=0.5),
        link("b", m=0.0, i=0, izz=0),
        joint("j1", "base", "a"),
        joint("j2", "a", "b"),
    )
    warnings = load_robot(path).warnings
    assert any("link 'a'" in w and "triangle inequality" in w for w in warnings)
    assert any("joint 'j2'" in w and "mass 0" in w for w in warnings)


def test_a_range_without_width_is_no_limit_and_gives_a_warning(urdf):
    path = urdf(link("base"), link("a"), joint("j1", "base", "a", lower=0, upper=0))
    robot = load_robot(path)
    assert np.isinf(robot.limits.upper).all()
    assert any("range is [0, 0]" in w for w in robot.warnings)


BASE_AND_ARM = link("base") + link("a")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("once upon a time", "not an XML file"),
        ("<mujoco/>", "begins with <robot>"),
        ("<robot/>", "needs a name"),
        ('<robot name="x"/>', "no <link>"),
        (f'<robot name="x">{BASE_AND_ARM}</robot>', "exactly one link without a parent"),
        (
            f'<robot name="x">{BASE_AND_ARM}{joint("j", "base", "hand")}</robot>',
            "child link 'hand', which is not",
        ),
        (
            f'<robot name="x">{BASE_AND_ARM}{joint("j", "base", "a", "spherical")}</robot>',
            "unknown type 'spherical'",
        ),
        (f'<robot name="x">{BASE_AND_ARM}{joint("j", "base", "a", "fixed")}</robot>', "no movable joint"),
        (
            f'<robot name="x">{BASE_AND_ARM}{joint("j", "base", "a", "floating")}</robot>',
            "more than one degree",
        ),
        (
            f'<robot name="x">{link("base")}{link("a", m="heavy")}{joint("j", "base", "a")}</robot>',
            "must be a number",
        ),
        (
            f'<robot name="x">{link("base")}<link name="a"/>{joint("j", "base", "a")}</robot>',
            "no moving link has a mass",
        ),
    ],
)
def test_a_bad_file_is_refused_in_one_line(urdf, text, said):
    with pytest.raises(RobotError) as error:
        load_robot(urdf(text=text))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_and_a_xacro_are_refused_by_name(tmp_path):
    with pytest.raises(RobotError, match=r"no such URDF file: .*nowhere\.urdf"):
        load_robot(tmp_path / "nowhere.urdf")
    (tmp_path / "arm.urdf.xacro").write_text("<robot/>")
    with pytest.raises(RobotError, match="must be expanded first"):
        load_robot(tmp_path / "arm.urdf.xacro")


def test_an_unknown_joint_to_lock_is_refused_with_the_nearest_ones():
    with pytest.raises(RobotError, match=r"'wrist_4_joint'.*wrist_"):
        load_robot("ur5", lock=["wrist_4_joint"])


def test_a_robot_without_moving_joints_is_refused():
    with pytest.raises(RobotError, match="no movable joint"):
        load_robot("ur5", lock=["*"])


def test_the_example_robots_are_found_where_they_are_installed():
    assert (example_robots_dir() / "ur_description").is_dir()
