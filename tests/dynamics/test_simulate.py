"""Simulation: the laws of mechanics, another integrator, and what the sensors make of it."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cdia_pin.dynamics import (
    ComputedTorque,
    Dynamics,
    Reference,
    Sensors,
    exciting_trajectory,
    run_plant,
    simulate,
)
from cdia_pin.dynamics.smoothing import Stiffness
from cdia_pin.effects import parse_term
from cdia_pin.errors import ModelError
from cdia_pin.logs import read_log, write_log
from cdia_pin.robot import load_robot


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


@pytest.fixture(scope="module")
def arm():
    return load_robot("ur5")


@dataclass(frozen=True)
class Hold:
    """A posture to start from."""

    q: tuple[float, ...]
    duration: float = 2.0

    def __call__(self, t):
        q = np.broadcast_to(self.q, (*np.shape(t), len(self.q)))
        return Reference(q, 0 * q, 0 * q)


def free(t, q, v, reference):
    """Let go of the arm."""
    return np.zeros_like(q)


def plant(robot, *terms):
    return Dynamics(robot, tuple(parse_term(t, robot) for t in terms))


def swing(robot, seed=1, duration=4.0):
    return exciting_trajectory(robot, np.random.default_rng(seed), duration=duration, base=0.25)


def exact(model, trajectory, controller, end, width, start=None):
    """The same closed loop in continuous time, by an eighth-order Runge-Kutta method at tight tolerance."""
    n = model.robot.n

    def rate(t, y):
        q, v = y[:n], y[n:]
        tau = controller(t, q, v, trajectory(t))
        return np.concatenate([v, model.forward_dynamics(q, v, tau, t, width)])

    y0 = np.concatenate([trajectory(0.0).q if start is None else start, np.zeros(n)])
    return solve_ivp(rate, (0.0, end), y0, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]


# ------------------------------------------------------------------ mechanics

SMOOTH = ["viscous_friction@joint1: coefficient=.002", "position_ripple@joint2: sine=.01, cosine=.02"]
HEAVY = ["rotor_inertia@joint1: inertia=.001", "actuator_gain@joint2: gain=-.2", "tool_wrench: force_z=.1"]
DRY = ["coulomb_friction@joint1: level=.02", "stribeck_friction@joint2: level=.005, breakaway=.005, decay=5"]


@pytest.mark.parametrize("terms", [[], SMOOTH, HEAVY, DRY], ids=["bare", "smooth", "heavy", "dry"])
def test_it_converges_to_another_integrator_in_second_order(pendulum, terms):
    model, trajectory = plant(pendulum, *terms), swing(pendulum)
    controller = ComputedTorque(Dynamics(pendulum))
    width = np.full(2, 0.05)  # the same friction for all steps
    truth = exact(model, trajectory, controller, 1.0, width)
    error = []
    for step in (1e-3, 5e-4):
        run = _with_width(model, trajectory, controller, 1.0, step, width)
        error.append(np.abs(np.concatenate([run.q[-1], run.v[-1]]) - truth).max())
    assert error[0] < 2e-3
    assert error[1] < 0.3 * error[0] or error[1] < 1e-9


def test_a_falling_arm_agrees_with_another_integrator(pendulum):
    start = Hold((1.0, 0.5))
    truth = exact(Dynamics(pendulum), start, free, 0.5, 1e-3)
    run = run_plant(Dynamics(pendulum), start, free, duration=0.5, step=2e-4)
    np.testing.assert_allclose(run.q[-1], truth[:2], atol=2e-4)


def mechanical_energy(robot, q, v):
    """Kinetic energy and the potential energy of the links' weights [J], shape (N,)."""
    kinetic = 0.5 * np.einsum("ni,nij,nj->n", v, robot.mass_matrix(q), v)
    pose = robot.joint_placements(q)
    mass, first = robot.inertial_parameters[:, 0], robot.inertial_parameters[:, 1:4]
    moments = np.einsum("nlij,lj->nli", pose[:, :, :3, :3], first) + mass[:, None] * pose[:, :, :3, 3]
    return kinetic - moments.sum(axis=1) @ robot.gravity_vector


@pytest.mark.parametrize("terms", [[], SMOOTH, HEAVY, DRY], ids=["bare", "smooth", "heavy", "dry"])
def test_energy_changes_by_the_work_of_all_torques(pendulum, terms):
    model = plant(pendulum, *terms)
    run = run_plant(model, swing(pendulum), step=2e-4, duration=3.0)
    energy = mechanical_energy(pendulum, run.q, run.v)
    power = np.einsum("ni,ni->n", run.v, run.effort + model.missing_torque(run.state(model)))
    work = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(run.time))])
    np.testing.assert_allclose(energy - energy[0], work, atol=2e-3 * np.ptp(energy))


def test_an_arm_without_friction_keeps_its_energy(pendulum):
    run = run_plant(Dynamics(pendulum), Hold((1.0, 0.5)), free, step=1e-4, duration=2.0)
    energy = mechanical_energy(pendulum, run.q, run.v)
    assert np.ptp(energy) < 2e-3 * np.ptp(
        0.5 * np.einsum("ni,nij,nj->n", run.v, pendulum.mass_matrix(run.q), run.v)
    )


def test_a_damped_arm_comes_to_rest_where_gravity_is_balanced(pendulum):
    model = plant(pendulum, *(f"viscous_friction@{j}: coefficient=.03" for j in pendulum.joints))
    run = run_plant(model, Hold((2.5, 0.5), duration=20.0), free)
    assert np.abs(run.v[-1]).max() < 1e-3
    np.testing.assert_allclose(pendulum.gravity(run.q[-1]), 0.0, atol=1e-4)
    assert (np.diff(mechanical_energy(pendulum, run.q, run.v)) < 1e-6).all()


def test_dry_friction_holds_a_joint_without_chatter(arm):
    model = plant(arm, "coulomb_friction@elbow_joint: level=8")
    trajectory = Hold((0.0, -1.0, 1.0, 0.0, 0.5, 0.0))
    slipping = arm.gravity(np.array(trajectory.q))

    def push(t, q, v, reference):
        return slipping + 2.0 * np.sin(5 * t) * (np.arange(6) == 2)  # less than friction

    run = run_plant(model, trajectory, push)
    j = arm.joint_index("elbow_joint")
    assert np.abs(run.v[:, j]).max() < run.sign_width[j]  # it creeps below the smoothing, no more
    assert (np.diff(np.sign(run.v[10:, j])) != 0).sum() <= 8  # as often as the push changes its sign


def test_friction_is_as_sharp_as_the_step_allows(arm):
    stiffness = Stiffness.of(plant(arm, "coulomb_friction@elbow_joint: level=5"), swing(arm))
    fine, coarse = stiffness.sign_width(1e-4), stiffness.sign_width(1e-3)
    j = arm.joint_index("elbow_joint")
    assert coarse[j] == pytest.approx(10 * fine[j], rel=1e-6)
    least = 1 / np.linalg.inv(arm.mass_matrix(swing(arm)(1.3).q))[j, j]
    assert coarse[j] > 5.0 * 1e-3 / least  # α h / m, the chatter itself
    assert stiffness.step(None) < 1e-3
    assert Stiffness.of(Dynamics(arm), swing(arm)).step(None) == 1e-3


def test_the_sharpness_does_not_depend_on_when_friction_appears(arm):
    now, later = (
        Stiffness.of(plant(arm, f"coulomb_friction@elbow_joint: level=5{when}"), swing(arm))
        for when in ("", ", after=3")
    )
    np.testing.assert_array_equal(now.sign_width(1e-3), later.sign_width(1e-3))


# ------------------------------------------------------------------ control


def test_the_nominal_arm_follows_its_reference(arm):
    trajectory = swing(arm)
    log = simulate(Dynamics(arm), trajectory)
    np.testing.assert_allclose(log.position, trajectory(log.time).q, atol=2e-5)
    np.testing.assert_allclose(log.effort, arm.inverse_dynamics(*trajectory(log.time)), atol=0.05)


def test_a_controller_that_knows_the_fault_follows_better(arm):
    trajectory = swing(arm)
    faulty = plant(arm, "payload: mass=2", "actuator_gain@elbow_joint: gain=-.3")
    error = {}
    for name, knows in (("nominal", Dynamics(arm)), ("accommodating", faulty)):
        log = simulate(faulty, trajectory, ComputedTorque(knows))
        error[name] = np.sqrt(np.mean((log.position - trajectory(log.time).q) ** 2))
    assert error["accommodating"] < 0.01 * error["nominal"]


def test_efforts_stay_within_the_limits(arm):
    heavy = plant(arm, "payload: mass=40")
    limited = simulate(heavy, swing(arm), duration=1.0)
    assert (np.abs(limited.effort) <= arm.limits.effort).all()
    assert (np.abs(limited.effort).max(axis=0) == arm.limits.effort).any()
    free_of_them = ComputedTorque(Dynamics(arm), limited=False)
    assert (np.abs(simulate(heavy, swing(arm), free_of_them, duration=1.0).effort) > arm.limits.effort).any()


# ------------------------------------------------------------------ what the sensors make of it


def test_the_log_balances_with_the_model_of_its_plant(arm):
    """Second differences of the positions are the accelerations that the recorded torques cause."""
    model = plant(
        arm,
        "coulomb_friction@elbow_joint: level=2",
        "payload: mass=1",
        "encoder_offset@elbow_joint: offset=.05",
    )
    log = simulate(model, swing(arm), rate=1000.0, step=1e-3)
    h = 1e-3
    a = (log.position[2:] - 2 * log.position[1:-1] + log.position[:-2]) / h**2
    width = Stiffness.of(model, swing(arm)).sign_width(h)
    tau = model.inverse_dynamics(log.position[1:-1], log.velocity[1:-1], a, sign_width=width)
    np.testing.assert_allclose(tau, log.effort[1:-1], atol=1e-6)


def test_encoders_read_where_the_arm_is_less_their_offset(arm):
    j = arm.joint_index("elbow_joint")
    model, trajectory = plant(arm, "encoder_offset@elbow_joint: offset=.1"), swing(arm)
    run, log = run_plant(model, trajectory), simulate(model, trajectory, rate=1000.0)
    np.testing.assert_allclose(run.q - log.position, 0.1 * (np.arange(6) == j) + 0 * run.q, atol=1e-12)
    np.testing.assert_allclose(log.position[0], trajectory(0.0).q, atol=1e-12)
    np.testing.assert_allclose(log.position[-1], trajectory(9.0).q, atol=0.02)  # control trusts its encoders


def test_an_encoder_offset_is_a_change_of_coordinates(pendulum):
    """Integrating the read position with the offset as a torque is the same motion."""
    model, trajectory = plant(pendulum, "encoder_offset@joint2: offset=.2", *SMOOTH), swing(pendulum)
    controller = ComputedTorque(Dynamics(pendulum))
    truth = exact(model, trajectory, controller, 1.0, 1e-3)  # forward dynamics at read positions
    run = run_plant(model, trajectory, controller, duration=1.0, step=2e-4)
    np.testing.assert_allclose(run.q[-1] - [0.0, 0.2], truth[:2], atol=2e-5)


def test_an_encoder_that_slips_moves_the_reading_not_the_arm(arm):
    model = plant(arm, "encoder_offset@elbow_joint: offset=.1, after=2")
    run, log = run_plant(model, swing(arm)), simulate(model, swing(arm), rate=1000.0)
    j = arm.joint_index("elbow_joint")
    assert np.abs(np.diff(run.q, axis=0)).max() < 0.005
    jump = np.diff(log.position[:, j])
    assert np.argmin(jump) == pytest.approx(1999, abs=1)
    assert jump.min() == pytest.approx(-0.1, abs=0.005)


def test_a_late_torque_reading_changes_the_reading_only(arm):
    late, on_time = (
        simulate(plant(arm, *terms), swing(arm), rate=1000.0) for terms in (["effort_delay: delay=.05"], [])
    )
    np.testing.assert_array_equal(late.position, on_time.position)
    np.testing.assert_allclose(late.effort[100:], on_time.effort[50:-50], atol=1e-6)


def test_a_fault_changes_nothing_before_its_onset(arm):
    faulty, healthy = (
        simulate(plant(arm, *terms), swing(arm), step=1e-3)
        for terms in (["viscous_friction@elbow_joint: coefficient=5, after=2"], [])
    )
    before = faulty.time < 2.0
    np.testing.assert_allclose(faulty.position[before], healthy.position[before], atol=1e-12)
    assert np.abs(faulty.effort - healthy.effort)[~before].max() > 1.0


def test_noise_has_the_requested_size_and_seed(arm):
    sensors = Sensors(position_noise=1e-4, velocity_noise=1e-2, effort_noise=0.3, effort_share=0.1)
    clean = simulate(Dynamics(arm), swing(arm))
    noisy, again, other = (
        simulate(Dynamics(arm), swing(arm), sensors=sensors, rng=np.random.default_rng(s)) for s in (1, 1, 2)
    )
    np.testing.assert_array_equal(noisy.effort, again.effort)
    assert not np.array_equal(noisy.effort, other.effort)
    assert np.std(noisy.position - clean.position) == pytest.approx(1e-4, rel=0.05)
    assert np.std(noisy.velocity - clean.velocity) == pytest.approx(1e-2, rel=0.05)
    size = 0.3 + 0.1 * np.sqrt(np.mean(clean.effort**2, axis=0))
    np.testing.assert_allclose(np.std(noisy.effort - clean.effort, axis=0), size, rtol=0.1)


def test_encoder_readings_are_multiples_of_the_quantum(arm):
    log = simulate(Dynamics(arm), swing(arm), sensors=Sensors(position_quantum=1e-3, velocity=False))
    np.testing.assert_allclose(log.position / 1e-3, np.round(log.position / 1e-3), atol=1e-9)
    assert log.velocity is None


def test_a_simulated_log_is_written_and_read(arm, tmp_path):
    log = simulate(Dynamics(arm), swing(arm), rate=100.0)
    assert log.rate == pytest.approx(100.0)
    assert log.duration == pytest.approx(4.0)
    assert "ur5" in log.source
    again = read_log(write_log(log, tmp_path / "log.csv"), arm)
    np.testing.assert_array_equal(again.position, log.position)
    np.testing.assert_array_equal(again.effort, log.effort)


def test_progress_is_reported(arm):
    shares: list[float] = []
    simulate(Dynamics(arm), swing(arm), duration=1.0, progress=shares.append)
    assert len(shares) > 5
    assert shares == sorted(shares) and shares[0] >= 0.0 and shares[-1] <= 1.0


def test_friction_that_is_not_sharp_is_noted(arm):
    model = plant(arm, "coulomb_friction@elbow_joint: level=30")
    assert "elbow_joint" in simulate(model, swing(arm), duration=0.1, step=1e-3).notes[-1]
    assert simulate(Dynamics(arm), swing(arm), duration=0.1).notes == ()


# ------------------------------------------------------------------ what cannot be simulated


def test_a_diverging_simulation_is_refused_with_joint_and_time(arm):
    with pytest.raises(ModelError, match=r"diverged: \w+_joint is faster than .* at"):
        simulate(plant(arm, "viscous_friction@elbow_joint: coefficient=-30"), swing(arm))


def test_an_arm_of_negative_inertia_is_refused(arm):
    with pytest.raises(
        ModelError, match="negative inertia along the motion because of rotor_inertia@elbow_joint"
    ):
        simulate(plant(arm, "rotor_inertia@elbow_joint: inertia=-.3"), swing(arm))


def test_a_step_too_large_for_the_friction_is_refused(arm):
    model = plant(arm, "viscous_friction@wrist_3_joint: coefficient=20")
    assert simulate(model, swing(arm), duration=0.2).duration == pytest.approx(0.2)  # takes smaller steps
    with pytest.raises(ModelError, match="a step must be above 0"):
        simulate(model, swing(arm), step=5e-3)
    with pytest.raises(ModelError, match="too fast to simulate"):
        simulate(plant(arm, "viscous_friction@wrist_3_joint: coefficient=2000"), swing(arm))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"rate": 0.0}, "rate"),
        ({"rate": 1e12}, "rate"),
        ({"duration": 0.0}, "duration"),
        ({"duration": -1.0}, "duration"),
        ({"step": 0.0}, "step"),
        ({"duration": 1e9}, "at most 3e\\+07 are possible"),
        ({"step": -1.0}, "step"),
        ({"sensors": Sensors(effort_noise=1.0)}, "rng"),
    ],
)
def test_settings_out_of_range_are_refused(arm, wrong, message):
    with pytest.raises(ModelError, match=message):
        simulate(Dynamics(arm), swing(arm), **wrong)


def test_sensors_cannot_have_negative_noise():
    with pytest.raises(ModelError, match="effort_share"):
        Sensors(effort_share=-0.1)
    with pytest.raises(ModelError, match="effort_share must be up to 10"):
        Sensors(effort_share=1e300)
    with pytest.raises(ModelError, match="stiffness"):
        ComputedTorque(Dynamics(load_robot("ur5")), stiffness=-1.0)


def _with_width(model, trajectory, controller, end, step, width):
    class Fixed:
        def sign_width(self, step):
            return width

    return run_plant(model, trajectory, controller, Fixed(), duration=end, step=step)
