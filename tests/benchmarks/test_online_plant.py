"""The closed loop's physics: M q̈ + nle = τ + f with the plant's own M, and sensors and drives as stated."""

import numpy as np
import pytest

from cdia_pin.errors import EffectError
from cdia_pin.robot import load_robot

pytest.importorskip("mujoco")

from benchmarks.online import (
    EXACT,
    POSITION_ONLY,
    Drives,
    NominalControl,
    OnlinePlant,
    Sensors,
    torque_of,
)
from benchmarks.online.faults import ONLINE
from benchmarks.online.scenarios import BANK, FURTHER, UNKNOWN
from benchmarks.plant import CLEAN, Fault
from benchmarks.plant.urdf import read_inertia

ELBOW = "elbow_joint"


@pytest.fixture(scope="module")
def plant() -> OnlinePlant:
    return OnlinePlant("ur5", seed=1)


def nominal_run(plant: OnlinePlant, faults=(), duration=2.0, seed=0):
    return plant.run(NominalControl(plant.robot), plant.reference(seed=3), faults, duration, seed)


def torque_lacking(plant: OnlinePlant, run) -> np.ndarray:
    """Return M q̈ + nle − τ of the plant without faults, from MuJoCo's inverse dynamics."""
    return plant.arm().inverse_dynamics(run.q, run.v, run.a) - run.arrived


# ---------------------------------------------------------------- rigid bodies


@pytest.mark.parametrize("name", ["scara", "ur5", "panda", "xarm7"])
def test_without_faults_and_model_error_computed_torque_tracks(name: str) -> None:
    plant = OnlinePlant(name, model_error=0.0, sensors=EXACT)
    run = nominal_run(plant, duration=3.0)
    np.testing.assert_allclose(run.q, run.reference.q, atol=1e-3)
    assert np.ptp(run.q, axis=0).min() > 1e-3  # it did move
    np.testing.assert_array_equal(run.fault_torque, 0.0)


@pytest.mark.parametrize("name", ["ur5", "kinova", "talos_arm", "scara"])
def test_controllers_model_is_the_packages(name: str) -> None:
    robot = load_robot(name)
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, robot.n))
    body = NominalControl(robot).body
    np.testing.assert_allclose(body.inverse_dynamics(q, v, a), robot.inverse_dynamics(q, v, a), rtol=1e-9)
    momentum, passive = body.momentum_terms(q, v)
    np.testing.assert_allclose(momentum, robot.mass_matrix(q) @ v, rtol=1e-9)
    # Ṁ = C + Cᵀ, so that Cᵀq̇ − g = Ṁ q̇ − nle
    h = 1e-6
    rate = (robot.mass_matrix(q + h * v) - robot.mass_matrix(q - h * v)) / (2 * h)
    np.testing.assert_allclose(passive, rate @ v - robot.nonlinear_effects(q, v), atol=1e-6)


def test_model_error_is_seeded_bounded_and_physical() -> None:
    one, again, other = (OnlinePlant("panda", seed=s) for s in (1, 1, 2))
    stated = one.nominal.nominal.file.inertias
    for name, link in stated.items():
        wrong = one.inertias[name]
        np.testing.assert_array_equal(wrong.com, again.inertias[name].com)
        assert wrong.mass == pytest.approx(link.mass, rel=0.03)
        assert np.linalg.norm(wrong.com - link.com) <= 0.03 * np.linalg.norm(link.com) + 1e-15
        before, after = (np.linalg.eigvalsh(x.tensor) for x in (link, wrong))
        np.testing.assert_allclose(after, before, rtol=0.03, atol=1e-12)
        assert link.mass == 0 or wrong.mass != other.inertias[name].mass
    arm, name = one.arm(), "panda_link5"
    assert read_inertia(arm.model, arm.model.body(name).id).mass == one.inertias[name].mass
    assert np.linalg.eigvalsh(arm.mass_matrix(np.full(7, 0.3))).min() > 0


def test_model_error_shows_as_missing_torque_of_that_size(plant: OnlinePlant) -> None:
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 40, 6))
    stated, true = (arm.inverse_dynamics(q, v, a) for arm in (plant.nominal.nominal, plant.arm()))
    share = np.sqrt(np.mean((true - stated) ** 2, axis=0) / np.mean(stated**2, axis=0))
    assert (share > 1e-4).all()
    assert (share < 0.06).all()


# ---------------------------------------------------------------- faults


@pytest.mark.parametrize("effect", sorted({*BANK, *FURTHER, *UNKNOWN, "fast_viscous_friction"}))
def test_faults_torque_is_what_the_plants_inverse_dynamics_leaves(effect: str, plant: OnlinePlant) -> None:
    other = "shoulder_lift_joint" if ONLINE[effect].places == 2 else None
    run = nominal_run(plant, [Fault(effect, joint=ELBOW, other=other, after=0.5)])
    f, lacking = run.fault_torque, torque_lacking(plant, run)
    np.testing.assert_allclose(f, lacking, atol=1e-6 * np.abs(f).max())
    assert np.abs(f[:, 2]).max() > 0.01
    np.testing.assert_array_equal(f[run.time < 0.5], 0.0)
    np.testing.assert_array_equal(np.delete(f, 2, axis=1), 0.0)  # and on no other joint


def test_faults_of_the_arm_itself_are_known_too(plant: OnlinePlant) -> None:
    run = nominal_run(plant, [Fault("payload", mass=1.0)], duration=1.0)
    lift = run.fault_torque[:, 1]
    assert np.abs(lift).mean() > 2.0  # [N·m], a kilogram on an arm of some decimetres
    np.testing.assert_allclose(run.fault_torque, torque_lacking(plant, run))


def test_fast_friction_is_there_only_above_its_speed(plant: OnlinePlant) -> None:
    fault = Fault("fast_viscous_friction", joint=ELBOW, coefficient=4.0, speed=0.3)
    run = nominal_run(plant, [fault], duration=4.0)
    v = run.v[:, 2]
    assert 0.1 < np.mean(np.abs(v) > 0.3) < 0.9
    np.testing.assert_allclose(run.fault_torque[:, 2], np.where(np.abs(v) > 0.3, -4.0 * v, 0.0), atol=1e-9)


def test_fault_that_vanishes_leaves_nothing_and_one_that_returns_is_the_same(plant: OnlinePlant) -> None:
    for effect, parameters in (("joint_spring", {"stiffness": 9.0}), ("rotor_inertia", {"inertia": 0.4})):
        here = Fault(effect, joint=ELBOW, until=0.8, **parameters)
        back = Fault(effect, joint=ELBOW, after=1.4, **parameters)
        run = nominal_run(plant, [here, back])
        there = (run.time < 0.8) | (run.time >= 1.4)
        np.testing.assert_array_equal(run.fault_torque[~there], 0.0)
        expected = -9.0 * run.q if effect == "joint_spring" else -0.4 * run.a
        np.testing.assert_allclose(run.fault_torque[there, 2], expected[there, 2], atol=1e-9)
        # Long after, the arm moves as if nothing had been.
        np.testing.assert_allclose(torque_lacking(plant, run)[~there], 0.0, atol=1e-9)


def test_fault_of_a_log_vanishes_too(plant: OnlinePlant) -> None:
    fault = Fault("viscous_friction", joint=ELBOW, coefficient=4.0, until=1.0)
    assert (fault.share(0.999), fault.share(1.0)) == (1.0, 0.0)
    assert fault.with_parameters({"coefficient": 5.0}).until == 1.0
    log_plant = plant.nominal
    truth = log_plant.run([fault], duration=2.0, noise=CLEAN, keep=False).truth
    f = log_plant.nominal.inverse_dynamics(truth.position, truth.velocity, truth.acceleration) - truth.effort
    expected = np.where(truth.time < 1.0, -4.0 * truth.velocity[:, 2], 0.0)
    np.testing.assert_allclose(f[:, 2], expected, atol=1e-9)
    with pytest.raises(EffectError, match="all the time"):
        log_plant.run([Fault("encoder_offset", joint=ELBOW, until=1.0)], duration=1.0)


def test_two_springs_on_a_joint_add_up(plant: OnlinePlant) -> None:
    one = Fault("joint_spring", joint=ELBOW, stiffness=5.0, preload=2.0)
    two = Fault("joint_spring", joint=ELBOW, stiffness=3.0, preload=-1.0, after=0.3, until=0.6)
    run = nominal_run(plant, [one, two], duration=1.0)
    there = (run.time >= 0.3) & (run.time < 0.6)
    q = run.q[:, 2]
    np.testing.assert_allclose(run.fault_torque[:, 2], 2.0 - 5.0 * q - there * (3.0 * q + 1.0), atol=1e-9)


def test_parts_of_several_faults_add_up_and_are_each_their_own(plant: OnlinePlant) -> None:
    faults = [
        Fault("viscous_friction", joint=ELBOW, coefficient=4.0, after=0.3),
        Fault("coulomb_friction", joint=ELBOW, level=3.0),
        Fault("actuator_gain", joint=ELBOW, gain=-0.2, until=0.7),
        Fault("joint_spring", joint="wrist_1_joint", stiffness=1.0),
    ]
    run = nominal_run(plant, faults, duration=1.0)
    viscous, dry, gain, spring = parts = [torque_of(plant, run, f) for f in faults]
    moving = np.abs(run.v[:, 2]) > 0.02
    np.testing.assert_allclose(sum(parts)[moving], run.fault_torque[moving], atol=1e-6)
    late = run.time >= 0.3
    np.testing.assert_allclose(viscous[late, 2], -4.0 * run.v[late, 2], atol=1e-6)
    np.testing.assert_allclose(dry[moving, 2], -3.0 * np.sign(run.v[moving, 2]), atol=1e-3)
    np.testing.assert_allclose(gain[:, 2], np.where(run.time < 0.7, -0.2 * run.arrived[:, 2], 0), atol=1e-6)
    np.testing.assert_allclose(spring[:, 3], -1.0 * run.q[:, 3], atol=1e-6)


@pytest.mark.parametrize("effect", ["effort_delay", "coulomb", "encoder_offset"])
def test_fault_that_the_closed_loop_cannot_have_is_refused(effect: str, plant: OnlinePlant) -> None:
    with pytest.raises(EffectError, match="online plant"):
        nominal_run(plant, [Fault(effect, joint=ELBOW)])


# ---------------------------------------------------------------- sensors and drives


def test_sensors_round_positions_and_add_white_noise_to_velocities(plant: OnlinePlant) -> None:
    run = nominal_run(plant, seed=5)
    steps = run.q_measured / 2e-5
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    assert np.abs(run.q_measured - run.q).max() <= 1e-5 + 1e-12
    assert run.v_measured is not None
    noise = run.v_measured - run.v
    np.testing.assert_allclose(noise.std(axis=0), 1e-3, rtol=0.1)
    assert np.abs(np.mean(noise[1:] * noise[:-1], axis=0)).max() < 1e-7


def test_sliding_joint_has_its_own_quantum_and_noise() -> None:
    plant = OnlinePlant("scara", sensors=Sensors(slide_quantum=5e-6, slide_velocity_std=2e-4))
    run = nominal_run(plant)
    assert run.v_measured is not None
    np.testing.assert_allclose((run.v_measured - run.v).std(axis=0), [1e-3, 1e-3, 1e-3, 2e-4], rtol=0.1)
    steps = run.q_measured[:, 3] / 5e-6
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_arm_can_be_held_with_positions_alone() -> None:
    plant = OnlinePlant("ur5", sensors=POSITION_ONLY)
    seen = []
    control = NominalControl(plant.robot)

    def spy(t, q, v, reference):
        seen.append(v)
        return control(t, q, v, reference)

    run = plant.run(spy, plant.reference(seed=3), (), 1.0)
    assert run.v_measured is None
    assert all(v is None for v in seen)
    np.testing.assert_allclose(run.q, run.reference.q, atol=0.01)


@pytest.mark.parametrize("delay", [0.0, 0.001, 0.0035])
def test_delayed_torque_arrives_late_by_just_that(delay: float) -> None:
    plant = OnlinePlant("ur5", model_error=0.0, sensors=EXACT, drives=Drives(delay=delay))
    hold = plant.robot.gravity(np.zeros(6))
    step = np.array([0, 0, 5.0, 0, 0, 0])
    rest = plant.reference()(np.zeros(1))

    def jump(t, q, v, reference):
        return hold + (step if t >= 0.1 - 1e-9 else 0.0)

    still = lambda t: type(rest)(*(np.zeros((len(t), 6)) for _ in rest))  # noqa: E731
    run = plant.run(jump, still, (), 0.2)
    felt = run.time[np.argmax(np.abs(run.a[:, 2]) > 0.1)]
    assert felt == pytest.approx(np.ceil((0.1 + delay) * 1000 - 1e-6) / 1000)
    ticks = int(delay * 1000)
    if delay * 1000 == ticks:
        np.testing.assert_array_equal(run.arrived[ticks:], run.command[: len(run.time) - ticks])
    # A late torque is not a fault: what arrives is what the arm answers to.
    np.testing.assert_array_equal(run.fault_torque, 0.0)


def test_torque_is_limited_by_the_drives(plant: OnlinePlant) -> None:
    most = plant.robot.limits.effort
    run = plant.run(lambda t, q, v, r: np.full(6, 3.0) * most, plant.reference(), (), 0.02)
    np.testing.assert_array_equal(run.arrived, np.tile(most, (20, 1)))
    np.testing.assert_array_equal(run.command, 3 * run.arrived)


def test_run_is_the_same_again_and_other_with_another_seed(plant: OnlinePlant) -> None:
    fault = [Fault("coulomb_friction", joint=ELBOW, level=3.0, after=0.2)]
    first, again, other = (nominal_run(plant, fault, 0.5, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.q, again.q)
    np.testing.assert_array_equal(first.command, again.command)
    assert np.abs(first.command - other.command).max() > 1e-3


def test_a_diverging_arm_is_an_error(plant: OnlinePlant) -> None:
    with pytest.raises(FloatingPointError, match="diverged"):
        plant.run(lambda t, q, v, r: 50.0 * v, plant.reference(), (), 2.0)


def test_physical_steps_are_short_enough(plant: OnlinePlant) -> None:
    """Half the step: the same motion, so what a monitor sees is not the integrator."""
    fine = OnlinePlant("ur5", seed=1, sensors=EXACT)
    fine.nominal.step = 2.5e-4
    coarse = OnlinePlant("ur5", seed=1, sensors=EXACT)
    fault = [Fault("viscous_friction", joint=ELBOW, coefficient=5.0, after=0.3)]
    one, two = (nominal_run(p, fault, 1.0) for p in (coarse, fine))
    np.testing.assert_allclose(one.q, two.q, atol=1e-5)
    np.testing.assert_allclose(one.command, two.command, atol=1e-2)


def test_velocities_are_those_of_the_positions_where_a_torque_is_steep_over_speed() -> None:
    """With too long a step they alternate about the true one, and each tick sees the same side of it."""
    plant = OnlinePlant("panda", sensors=EXACT)
    bump = Fault("speed_bump", joint="panda_joint3", level=6.9, speed=0.25, width=0.06)
    run = plant.run(NominalControl(plant.robot), plant.reference(seed=4), [bump], 3.0)
    moved = 0.5 * (run.v[1:] + run.v[:-1]) * np.diff(run.time)[:, None]
    over_a_second = np.cumsum(np.diff(run.q, axis=0) - moved, axis=0)
    assert np.abs(over_a_second[1000:] - over_a_second[:-1000]).max() < 1e-3
