"""The URDF of an arm alone."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.errors import RobotError
from cdia_pin.robot import catalogue
from cdia_pin.robot.arm_urdf import write_arm_urdf

BAXTER = {"right_*": None, "head_pan": 0.3}


def test_it_is_one_chain_with_the_same_dynamics(tmp_path):
    arm = load_robot(catalogue()["baxter_left_arm"].path, lock=BAXTER)
    alone = load_robot(write_arm_urdf(arm, tmp_path / "alone.urdf"))
    assert (alone.joints, dict(alone.locked)) == (arm.joints, {})
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 20, arm.n))
    np.testing.assert_allclose(
        alone.inverse_dynamics(q, v, a), arm.inverse_dynamics(q, v, a), rtol=1e-9, atol=1e-9
    )


def test_a_fixed_joint_has_nothing_of_a_motion(tmp_path):
    arm = load_robot(catalogue()["baxter_left_arm"].path, lock=BAXTER)
    text = write_arm_urdf(arm, tmp_path / "alone.urdf").read_text()
    head = text[text.index('<joint name="head_pan"') :].split("</joint>")[0]
    assert 'type="fixed"' in head
    assert "<limit" not in head and "<axis" not in head


def test_the_original_is_kept(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(catalogue()["scara"].path.read_text())
    with pytest.raises(RobotError, match="own file"):
        write_arm_urdf(load_robot(path), path)
    with pytest.raises(RobotError, match="cannot write"):
        write_arm_urdf(load_robot(path), tmp_path / "no" / "folder.urdf")
