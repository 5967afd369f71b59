"""What is written into a URDF is what any reader of it gets back, and the rest of the file stays."""

import numpy as np
import pinocchio as pin
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.robot import RobotModel, load_robot, write_corrected_urdf
from cdia_pin.robot.inertia import is_physical, parameters_of, transform_parameters

ARMS = ("ur5", "panda", "scara", "tiago", "kinova", "so100", "baxter_left_arm")


def reload(robot: RobotModel, path) -> RobotModel:
    return load_robot(path, lock=robot.locked, tool_frame=robot.tool_frame, gravity=robot.gravity_vector)


def heavier(robot: RobotModel, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Physically possible bodies: what is there, plus random points on it."""
    out = {}
    for joint, parameters in zip(robot.joints, robot.inertial_parameters, strict=True):
        points = [
            parameters_of(m, x, np.zeros((3, 3)))
            for m, x in zip(rng.uniform(0.1, 1, 4), rng.normal(0, 0.1, (4, 3)), strict=True)
        ]
        out[joint] = 1.1 * parameters + sum(points)
    return out


@pytest.mark.parametrize("name", ARMS)
def test_inertias_damping_and_friction_come_back(name, tmp_path):
    robot = load_robot(name)
    rng = np.random.default_rng(3)
    inertial = heavier(robot, rng)
    damping = dict(zip(robot.joints, rng.uniform(0, 5, robot.n), strict=True))
    friction = dict(zip(robot.joints, rng.uniform(0, 5, robot.n), strict=True))
    path = write_corrected_urdf(
        robot, tmp_path / "new.urdf", inertial=inertial, damping=damping, friction=friction
    )
    again = reload(robot, path)
    assert again.joints == robot.joints
    np.testing.assert_allclose(again.inertial_parameters, list(inertial.values()), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(again.urdf_damping, list(damping.values()))
    np.testing.assert_array_equal(again.urdf_friction, list(friction.values()))


@pytest.mark.parametrize("name", ARMS)
def test_the_same_inertias_give_the_same_robot(name, tmp_path):
    robot = load_robot(name)
    given = dict(zip(robot.joints, robot.inertial_parameters, strict=True))
    again = reload(robot, write_corrected_urdf(robot, tmp_path / "same.urdf", inertial=given))
    np.testing.assert_allclose(again.inertial_parameters, robot.inertial_parameters, rtol=1e-9, atol=1e-9)


def test_joints_that_are_not_given_stay_unchanged(tmp_path):
    robot = load_robot("ur5")
    new = 1.5 * robot.inertial_parameters[2]
    again = reload(robot, write_corrected_urdf(robot, tmp_path / "one.urdf", inertial={"elbow_joint": new}))
    np.testing.assert_allclose(again.inertial_parameters[2], new, rtol=1e-9, atol=1e-12)
    others = [0, 1, 3, 4, 5]
    np.testing.assert_array_equal(again.inertial_parameters[others], robot.inertial_parameters[others])


def test_locked_fingers_keep_their_own_inertia(tmp_path):
    robot = load_robot("panda")
    path = write_corrected_urdf(robot, tmp_path / "p.urdf", inertial=heavier(robot, np.random.default_rng(1)))
    before, after = (pin.buildModelFromUrdf(str(p)) for p in (robot.urdf, path))
    finger = before.getJointId("panda_finger_joint1")
    assert before.inertias[finger] == after.inertias[finger]


def test_a_missing_hand_can_be_subtracted(tmp_path):
    # The hand (0.73 kg) is half of the last body; less than the rest remains for the link itself.
    robot = load_robot("panda")
    less = 0.3 * robot.inertial_parameters[-1]
    path = write_corrected_urdf(robot, tmp_path / "p.urdf", inertial={"panda_joint7": less})
    again = reload(robot, path)
    np.testing.assert_allclose(again.inertial_parameters[-1], less, rtol=1e-9, atol=1e-12)
    assert again.warnings == ()


def test_a_payload_is_fixed_to_the_tool_frame(tmp_path):
    robot = load_robot("panda")
    payload = parameters_of(0.8, [0.01, 0.02, 0.05], 1e-3 * np.eye(3))
    again = reload(robot, write_corrected_urdf(robot, tmp_path / "p.urdf", payload=payload))
    expected = robot.inertial_parameters[-1] + transform_parameters(robot.tool_placement) @ payload
    np.testing.assert_allclose(again.inertial_parameters[-1], expected, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(again.inertial_parameters[:-1], robot.inertial_parameters[:-1])


def test_a_point_payload_needs_four_numbers(tmp_path):
    robot = load_robot("ur5")
    again = reload(robot, write_corrected_urdf(robot, tmp_path / "p.urdf", payload=[2.0, 0.0, 0.0, 0.1]))
    assert again.total_mass == pytest.approx(robot.total_mass + 2.0)


def test_a_negative_payload_is_subtracted_from_the_last_body(tmp_path):
    robot = load_robot("panda")
    hand = transform_parameters(np.linalg.inv(robot.tool_placement)) @ (-0.4 * robot.inertial_parameters[-1])
    again = reload(robot, write_corrected_urdf(robot, tmp_path / "p.urdf", payload=hand))
    np.testing.assert_allclose(again.inertial_parameters[-1], 0.6 * robot.inertial_parameters[-1], atol=1e-12)


def test_comments_meshes_and_order_stay(tmp_path):
    robot = load_robot("ur5")
    path = write_corrected_urdf(robot, tmp_path / "u.urdf", damping={"elbow_joint": 3.25})
    before, after = robot.urdf.read_text(), path.read_text()
    assert "corrected by cdia-pin" in after and "damping of elbow_joint" in after
    for tag in ("<!--", "<mesh", "<transmission", "<link", "<joint"):
        extra = 1 if tag == "<!--" else 0
        assert after.count(tag) == before.count(tag) + extra
    different = set(after.splitlines()) - set(before.splitlines())
    assert len(different) <= 4, different


def test_the_original_is_not_overwritten():
    robot = load_robot("ur5")
    with pytest.raises(RobotError, match="give another name"):
        write_corrected_urdf(robot, robot.urdf, damping={"elbow_joint": 1.0})


def test_relative_meshes_still_resolve(tmp_path):
    robot = load_robot("ur5")
    mesh = robot.urdf.parents[1] / "meshes"
    text = robot.urdf.read_text().replace(
        "package://example-robot-data/robots/ur_description/meshes", str(mesh.name)
    )
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    (tmp_path / "a" / "arm.urdf").write_text(text)
    mine = load_robot(tmp_path / "a" / "arm.urdf")
    written = write_corrected_urdf(mine, tmp_path / "b" / "arm.urdf").read_text()
    assert 'filename="../a/meshes/' in written


@pytest.mark.parametrize("factor", [-1.0, 0.0])
def test_unphysical_inertias_are_refused(factor, tmp_path):
    robot = load_robot("ur5")
    wrong = robot.inertial_parameters[2].copy()
    wrong[4:] *= factor  # no inertia, but a lever
    assert not is_physical(wrong)
    with pytest.raises(RobotError, match=r"elbow_joint.*no body can have"):
        write_corrected_urdf(robot, tmp_path / "x.urdf", inertial={"elbow_joint": wrong})
    assert not (tmp_path / "x.urdf").exists()
    path = write_corrected_urdf(
        robot, tmp_path / "x.urdf", inertial={"elbow_joint": wrong}, allow_unphysical=True
    )
    np.testing.assert_allclose(reload(robot, path).inertial_parameters[2], wrong, rtol=1e-9, atol=1e-12)


def test_wrong_requests_are_refused_by_name(tmp_path):
    robot = load_robot("ur5")
    path = tmp_path / "x.urdf"
    with pytest.raises(RobotError, match="elbow_joint"):
        write_corrected_urdf(robot, path, damping={"elbow": 1.0})
    with pytest.raises(RobotError, match="zero or more"):
        write_corrected_urdf(robot, path, friction={"elbow_joint": -1.0})
    with pytest.raises(RobotError, match="ten finite"):
        write_corrected_urdf(robot, path, inertial={"elbow_joint": [1.0, 2.0]})
    with pytest.raises(RobotError, match="payload"):
        write_corrected_urdf(robot, path, payload=[1.0])
    with pytest.raises(RobotError, match="cannot write"):
        write_corrected_urdf(robot, tmp_path / "no" / "x.urdf")
