"""Effects of real joints are found in logs whose plants are written here, from geometry and formulas."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, discover, load_robot
from cdia_pin.effects import Counterbalance, State
from cdia_pin.logs import Log
from tests.made_logs import make, motion

NOISE = 0.01  # [N·m], RMS; the arm's torque is some N·m


@pytest.fixture(scope="module")
def arm():
    return load_robot("double_pendulum")


def noisy(log: Log) -> Log:
    return replace(
        log, effort=log.effort + NOISE * np.random.default_rng(5).standard_normal(log.effort.shape)
    )


def only_step(robot, log):
    found = discover(Dynamics(robot), noisy(log))
    assert [s.term.effect.name for s in found.steps] == [found.steps[0].term.effect.name], found.steps
    return found.steps[0].term, found.verdict


def test_friction_in_proportion_to_the_load_that_falls_with_speed_is_found(arm):
    # at 100 Hz a reversal is between two samples, and so is the fall at rest
    made = make(arm, seed=3, rate=400.0)
    share = 0.1 + 0.25 * np.exp(-np.abs(made.v[:, 0]) / 0.15)
    load = made.log.effort[:, 0] / (1 - share * np.sign(made.v[:, 0]) * np.sign(made.log.effort[:, 0]))
    term, verdict = only_step(arm, replace(made.log, effort=np.column_stack([load, made.log.effort[:, 1]])))
    assert (term.label, verdict) == (f"load_stribeck_friction@{arm.joints[0]}", "explained")
    assert term.theta == pytest.approx((0.1, 0.25), rel=0.1)
    assert 1 / term.effect.decay == pytest.approx(0.15, rel=0.15)


TOP = -1.4  # [rad], where the shoulder of a UR5 holds its arm up


def spring(anchor, lever, energy):
    """The torque of a spring from an anchor to a point on the upper arm, whose energy depends on its length."""

    def of(q):
        at = lever * np.column_stack([np.sin(q), np.cos(q)])
        return energy(np.linalg.norm(at - anchor, axis=1))

    def missing(q, v, a):
        f = np.zeros_like(q)
        f[:, 1] = -(of(q[:, 1] + 1e-5) - of(q[:, 1] - 1e-5)) / 2e-5
        return f

    return missing


@pytest.mark.parametrize(
    ("side", "energy", "forces"),
    [
        (
            1,
            lambda length: 0.5 * 1500 * (length - 0.1) ** 2,
            (120, 480),
        ),  # a coil that pulls, 0.18 to 0.42 m long
        (-1, lambda length: -150 * length, (150, 150)),  # gas that pushes from the other side
    ],
)
def test_a_spring_between_two_points_that_holds_the_arm_up_is_a_counterbalance(side, energy, forces):
    robot = load_robot("ur5")
    anchor, lever = side * 0.3 * np.array([np.sin(TOP), np.cos(TOP)]), 0.12  # [m]
    term, verdict = only_step(robot, make(robot, spring(anchor, lever, energy), seed=3, noise=0.05).log)
    assert (term.label, verdict) == ("counterbalance@shoulder_lift_joint", "explained")
    assert term.effect.centre == pytest.approx(TOP, abs=0.02)
    assert term.effect.ratio == pytest.approx(side * 0.4, abs=0.02)
    assert term.theta == pytest.approx(lever * np.array(forces), rel=0.03)


def test_a_counterbalance_may_be_many_turns_from_zero():
    robot = load_robot("ur5")
    q = np.zeros((50, robot.n))
    q[:, 1] = 20.0 + np.linspace(-1.0, 1.0, len(q))
    still = np.zeros_like(q)
    shapes = Counterbalance("shoulder_lift_joint").shape_grid(State.of(robot, q, still, still))
    assert shapes
    assert all(abs(e.centre - 20.0) <= np.pi + 1e-9 for e in shapes)


def test_friction_that_halves_with_every_fifteen_kelvin_is_found_where_the_log_has_temperatures(arm):
    t, *_ = motion(arm.n, 3)
    warmth = 22 + 18 * (1 - np.exp(-t / 8))

    def missing(q, v, a):
        friction = (0.3 * np.sign(v[:, 1]) + 0.2 * v[:, 1]) * 0.5 ** ((warmth - 20) / 15)
        return np.column_stack([np.zeros(len(q)), -friction])

    log = make(arm, missing, seed=3).log
    measured = replace(log, temperature=np.round(np.column_stack([np.full(len(t), 22.0), warmth])))
    term, verdict = only_step(arm, measured)
    assert (term.label, verdict) == (f"thermal_friction@{arm.joints[1]}", "explained")
    assert term.theta == pytest.approx((0.3, 0.2), rel=0.1)
    assert np.log(2) / term.effect.decay == pytest.approx(15, rel=0.1)
    named = {s.term.effect.name for s in discover(Dynamics(arm), noisy(log)).steps}
    assert "thermal_friction" not in named


def test_a_link_behind_a_spring_is_elasticity_for_an_encoder_on_the_motor(arm):
    made = make(arm, seed=3)
    compliance = 0.02 / np.abs(made.log.effort[:, 0]).max()  # [rad/(N·m)], a bend of 20 mrad
    position = made.q.copy()
    position[:, 0] += compliance * made.log.effort[:, 0]
    term, _ = only_step(arm, replace(made.log, position=position))
    assert term.label == f"joint_elasticity@{arm.joints[0]}"
    assert term.theta[0] == pytest.approx(compliance, rel=0.2)
