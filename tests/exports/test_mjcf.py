"""MuJoCo, which we did not write, computes the same torques from the MJCF as the model that was exported."""

from pathlib import Path

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import parse_term
from cdia_pin.exports import FORMATS
from cdia_pin.robot.inertia import parameters_of

mujoco = pytest.importorskip(
    "mujoco", reason="MuJoCo is a development dependency: pip install 'cdia-pin[dev]'"
)

MJCF = FORMATS["mjcf"]
CLOSE = 0.01  # [1], largest difference of two RMS torques


def held_by_mjcf(robot) -> Dynamics:
    """A model with one term of every kind that an MJCF holds, on each joint that can have it."""
    turning = [j for j, slides in zip(robot.joints, robot.is_prismatic, strict=True) if not slides]
    box = dict(zip(("xx", "yy", "zz"), (0.004, 0.005, 0.003), strict=True))
    tool = ", ".join(f"inertia_{k}={v}" for k, v in box.items())
    texts = [
        *(f"viscous_friction@{j}: coefficient={0.5 + 0.3 * i}" for i, j in enumerate(robot.joints)),
        *(f"coulomb_friction@{j}: level={1.0 + 0.5 * i}" for i, j in enumerate(robot.joints)),
        *(f"rotor_inertia@{j}: inertia={0.1 + 0.05 * i}" for i, j in enumerate(robot.joints)),
        f"joint_spring@{turning[1]}: stiffness=4, preload=1.5",
        "base_tilt: tilt_x=0.6, tilt_y=-0.4",
        f"payload: mass=1.2, first_moment_x=0.01, first_moment_z=0.05, {tool}",
    ]
    model = Dynamics(robot, tuple(parse_term(t) for t in texts))
    joint = robot.joints[1]
    point = parameters_of(0.3, [0.02, 0.1, -0.05], np.diag([0.001, 0.002, 0.0015]))
    names = [p.name for p in parse_term(f"link_inertia@{joint}: mass=0").effect.parameters]
    given = ", ".join(f"{n}={v}" for n, v in zip(names, point, strict=True))
    return model.add(parse_term(f"link_inertia@{joint}: {given}"))


def mujoco_torques(text: str, joints, q, v, a) -> np.ndarray:
    """Inverse dynamics of an MJCF [N·m or N], shape (N, n)."""
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    data, at = mujoco.MjData(model), [model.joint(j).dofadr[0] for j in joints]
    out = []
    for sample in zip(q, v, a, strict=True):
        for signal, x in zip((data.qpos, data.qvel, data.qacc), sample, strict=True):
            signal[at] = x
        mujoco.mj_inverse(model, data)
        out.append(data.qfrc_inverse[at].copy())
    return np.array(out)


def motion(robot, seed: int, count: int = 40):
    """Random states in motion: at rest MuJoCo's friction takes any value up to its level."""
    rng = np.random.default_rng(seed)
    lower, upper = (np.clip(x, -2, 2) for x in (robot.limits.lower, robot.limits.upper))
    q = rng.uniform(lower, upper, (count, robot.n))
    v = rng.uniform(0.3, 1.5, q.shape) * rng.choice([-1, 1], q.shape)
    return q, v, rng.uniform(-3, 3, q.shape)


@pytest.mark.parametrize("name", ["ur5", "panda", "scara", "tiago", "so100", "kinova"])
def test_mujoco_computes_our_torque(name, record_property):
    robot = load_robot(name)
    model = held_by_mjcf(robot)
    values = MJCF.values(model)
    assert not values.left_out and not values.approximated
    q, v, a = motion(robot, 3)
    ours = model.inverse_dynamics(q, v, a)
    theirs = mujoco_torques(MJCF.text(model, values, Path()), robot.joints, q, v, a)
    difference, torque = (np.sqrt(np.mean(x**2, axis=0)) for x in (ours - theirs, ours))
    record_property("difference", float(difference.max() / torque.min()))
    assert difference.max() <= CLOSE * torque.min()


def test_the_mjcf_of_an_arm_without_terms_of_its_own_is_the_urdfs():
    robot = load_robot("ur5")
    model = Dynamics(robot, (parse_term("torque_offset@elbow_joint: offset=1"),))
    q, v, a = motion(robot, 4)
    theirs = mujoco_torques(MJCF.text(model, MJCF.values(model), Path()), robot.joints, q, v, a)
    np.testing.assert_allclose(theirs, robot.inverse_dynamics(q, v, a), rtol=1e-6, atol=1e-6)


def test_a_joint_that_slips_has_its_whole_friction_in_a_simulation():
    robot = load_robot("double_pendulum")
    model = Dynamics(robot, (parse_term("coulomb_friction@joint1: level=0.2"),))
    plant = mujoco.MjModel.from_xml_string(MJCF.text(model, MJCF.values(model), Path()))
    plant.opt.gravity[:] = 0.0
    data, at = mujoco.MjData(plant), plant.joint("joint1").dofadr[0]
    data.qvel[at] = 3.0
    mujoco.mj_forward(plant, data)
    assert data.qfrc_constraint[at] == pytest.approx(-0.2, rel=CLOSE)
