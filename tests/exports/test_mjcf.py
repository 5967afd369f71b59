"""MuJoCo, which we did not write, computes from MJCF and URDF the same torques as the model that was exported."""

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import parse_term
from cdia_pin.exports import FORMATS
from cdia_pin.robot.inertia import parameters_of

mujoco = pytest.importorskip(
    "mujoco", reason="MuJoCo is a development dependency: pip install 'cdia-pin[dev]'"
)

MJCF, URDF = FORMATS["mjcf"], FORMATS["urdf"]
NOT_IN_A_URDF = ("rotor_inertia", "joint_spring", "base_tilt")
STIFF = (0.9999, 0.9999, 0.001, 0.5, 2)  # docs/exports.md tells whoever loads a URDF to set it
# MuJoCo's dry friction is that of the speed this much later, at the present acceleration [s].
AHEAD = 0.0101
SHARP = 0.005  # [rad/s or m/s], speed above which our sgn is 1
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


def from_urdf(text: str):
    """MuJoCo's model of a URDF, without its shapes."""
    root = etree.fromstring(text.encode())
    etree.strip_elements(root, "visual", "collision", with_tail=False)
    return mujoco.MjModel.from_xml_string(etree.tostring(root, encoding="unicode"))


def mujoco_torques(model, joints, q, v, a) -> np.ndarray:
    """Inverse dynamics of MuJoCo [N·m or N], shape (N, n)."""
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    data, at = mujoco.MjData(model), [model.joint(j).dofadr[0] for j in joints]
    out = []
    for sample in zip(q, v, a, strict=True):
        for signal, x in zip((data.qpos, data.qvel, data.qacc), sample, strict=True):
            signal[at] = x
        mujoco.mj_inverse(model, data)
        out.append(data.qfrc_inverse[at].copy())
    return np.array(out)


def motion(robot, seed: int, count: int = 40, slow: bool = False):
    """Random states in motion: at rest MuJoCo's friction takes any value up to its level.

    In slow motion, the joints are as near to a reversal as MuJoCo's friction still has the sign of the speed.
    """
    rng = np.random.default_rng(seed)
    lower, upper = (np.clip(x, -2, 2) for x in (robot.limits.lower, robot.limits.upper))
    q = rng.uniform(lower, upper, (count, robot.n))
    v = rng.uniform(0.3, 1.5, q.shape) * rng.choice([-1, 1], q.shape)
    a = rng.uniform(-3, 3, q.shape)
    return q, np.copysign(np.maximum(AHEAD * np.abs(a), SHARP), v) if slow else v, a


def largest_difference(ours, theirs) -> float:
    """Largest RMS difference of a joint over the smallest RMS torque of one [1]."""
    difference, torque = (np.sqrt(np.mean(x**2, axis=0)) for x in (ours - theirs, ours))
    return float(difference.max() / torque.min())


@pytest.mark.parametrize("slow", [False, True], ids=["fast", "slow"])
@pytest.mark.parametrize("name", ["ur5", "panda", "scara", "tiago", "so100", "kinova"])
def test_mujoco_computes_our_torque(name, slow, record_property):
    robot = load_robot(name)
    model = held_by_mjcf(robot)
    values = MJCF.values(model)
    assert not values.left_out and not values.approximated
    q, v, a = motion(robot, 3, slow=slow)
    plant = mujoco.MjModel.from_xml_string(MJCF.text(model, values, Path()))
    difference = largest_difference(
        model.inverse_dynamics(q, v, a), mujoco_torques(plant, robot.joints, q, v, a)
    )
    record_property("difference", difference)
    assert difference <= CLOSE


@pytest.mark.parametrize("name", ["ur5", "panda", "kinova"])
def test_mujoco_computes_our_torque_from_the_corrected_urdf(name):
    robot = load_robot(name)
    held = [t for t in held_by_mjcf(robot).terms if t.effect.name not in NOT_IN_A_URDF]
    model = Dynamics(robot, tuple(held))
    values = URDF.values(model)
    assert not values.left_out and not values.approximated
    plant = from_urdf(URDF.text(model, values, Path()))
    plant.dof_solimp[:] = STIFF
    q, v, a = motion(robot, 3)
    v /= 3  # from 0.1 rad/s or m/s on; without rotor inertia the friction of light joints needs more to be whole
    ours, theirs = model.inverse_dynamics(q, v, a), mujoco_torques(plant, robot.joints, q, v, a)
    assert largest_difference(ours, theirs) <= CLOSE


def test_without_stiffer_friction_light_joints_of_a_urdf_have_less_of_it():
    robot = load_robot("kinova")
    model = Dynamics(robot, (parse_term(f"coulomb_friction@{robot.joints[-1]}: level=3"),))
    plant = from_urdf(URDF.text(model, URDF.values(model), Path()))
    q, v, a = motion(robot, 3)
    ours, theirs = model.inverse_dynamics(q, v, a), mujoco_torques(plant, robot.joints, q, v, a)
    assert largest_difference(ours, theirs) > CLOSE


def test_the_mjcf_of_an_arm_without_terms_of_its_own_is_the_urdfs():
    robot = load_robot("ur5")
    model = Dynamics(robot, (parse_term("torque_offset@elbow_joint: offset=1"),))
    q, v, a = motion(robot, 4)
    plant = mujoco.MjModel.from_xml_string(MJCF.text(model, MJCF.values(model), Path()))
    theirs = mujoco_torques(plant, robot.joints, q, v, a)
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
