"""Motions and cases: within limits, exact derivatives, faults of the size and at the time they are said to be."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from cdia_pin.robot import load_robot

pytest.importorskip("mujoco")

from benchmarks.online import Chain, NominalControl, OnlinePlant, Onward
from benchmarks.online import scenarios as s
from benchmarks.online.sizes import nominal, sizer


@pytest.mark.parametrize("name", s.ARMS)
@pytest.mark.parametrize("motion", [Onward(), Chain(piece=6.0, bridge=2.0)])
def test_motion_is_within_limits_with_exact_derivatives_and_a_smooth_start(name: str, motion) -> None:
    robot, t = load_robot(name), np.linspace(0, 20, 8001)
    q, v, a = nominal(name).plan(motion, 20.0, 1)(t)
    assert (q > robot.limits.lower).all()
    assert (q < robot.limits.upper).all()
    assert (np.abs(v) <= robot.limits.velocity).all()
    assert np.abs([v[0], a[0]]).max() < 1e-9
    np.testing.assert_allclose(cumulative_trapezoid(v, t, axis=0, initial=0), q - q[0], atol=1e-4)
    np.testing.assert_allclose(cumulative_trapezoid(a, t, axis=0, initial=0), v, atol=1e-3)
    assert (np.abs(v).max(axis=0) > 0.02).all()  # every joint moves


def test_onward_motion_does_not_fade_before_the_run_ends() -> None:
    v = nominal("ur5").plan(Onward(), 10.0, 0)(np.linspace(8, 10, 200)).v
    assert np.abs(v).max(axis=0).min() > 0.1


def test_shares_are_those_of_the_healthy_motion() -> None:
    case = next(c for c in s.singles("ur5", 0.2, ["quadratic_friction"], 1))
    (fault,) = case.faults
    look = sizer("ur5", case.duration, case.motion, s.BEGIN)
    j = look.plant.joints.index(fault.joint)
    t = np.linspace(3, 10, 1000)
    q, v, a = nominal("ur5").plan(Onward(), 10.0, case.motion)(t)
    f = -fault.parameters["coefficient"] * np.abs(v[:, j]) * v[:, j]
    torque = load_robot("ur5").inverse_dynamics(q, v, a)[:, j]
    assert np.sqrt(np.mean(f**2) / np.mean(torque**2)) == pytest.approx(0.2, rel=0.02)


def test_faults_of_a_run_have_about_their_share_from_their_time_on() -> None:
    plant = OnlinePlant("panda", seed=2)
    case = s.singles("panda", 0.2, ["viscous_friction"], 1)[0]
    run = case.run(plant, NominalControl(plant.robot))
    j = plant.joints.index(case.faults[0].joint)
    late = run.time >= s.BEGIN
    np.testing.assert_array_equal(run.fault_torque[~late], 0.0)
    rms = sizer("panda", 10.0, case.motion, s.BEGIN).rms[j]
    assert np.sqrt(np.mean(run.fault_torque[late, j] ** 2)) == pytest.approx(0.2 * rms, rel=0.1)
    assert not case.run(plant, NominalControl(plant.robot), healthy=True).fault_torque.any()


@pytest.fixture(scope="module")
def cases() -> list[s.Case]:
    return list(s.every_case("ur5"))


def test_cases_have_names_of_their_own_and_are_the_same_each_time(cases) -> None:
    assert len({c.id for c in cases}) == len(cases)
    again = {c.id: c for c in [*s.joining("ur5"), *s.singles("ur5", 0.1, ["actuator_gain"])]}
    assert again == {c.id: c for c in cases if c.id in again}


def test_suites_hold_what_they_promise(cases) -> None:
    of = {suite: [c for c in cases if c.suite == suite] for suite in {c.suite for c in cases}}
    assert {f.effect for c in of["single"] for f in c.faults} == {*s.BANK, *s.FURTHER}
    assert {c.faults[0].effect for c in of["unknown"]} == set(s.UNKNOWN)
    assert {frozenset(f.effect for f in c.faults) for c in of["pair"]} == {
        frozenset({a, b}) for a in s.MAIN for b in s.MAIN if a != b
    }
    assert all(len({f.joint for f in c.faults}) == 1 for c in of["pair"] + of["triple"])
    for case in of["return"]:
        first, back = case.faults
        assert (first.after, first.until, back.after) == (3.0, 6.0, 8.5)
        assert first.parameters == back.parameters
    for case in of["joining"]:
        assert [f.after for f in case.faults] == [3.0, 6.5]
        assert case.faults[0].effect != case.faults[1].effect
    assert {len({f.joint for f in c.faults}) for c in of["joining"]} == {1, 2}
    assert of["profile"]
    assert all(c.faults == () for c in of["healthy"] + s.healthy_hour("ur5"))
    assert sum(c.duration for c in s.healthy_hour("ur5")) == 3600.0


def test_faults_stand_out_of_the_sensors_noise_and_are_those_of_a_working_robot() -> None:
    for case in s.singles("xarm7", 0.1):
        look = sizer("xarm7", case.duration, case.motion, s.BEGIN)
        j = look.plant.joints.index(case.faults[0].joint)
        assert look.rms[j] * 0.1 > 3 * look.noise[j]
        assert look.loaded[j]
        rotor = case.faults[0].parameters.get("inertia", 0.0)
        assert rotor <= 1.01 * look.carried[j]


def test_a_combination_knows_what_else_it_is() -> None:
    assert s.same_torque(["torque_offset", "joint_spring"])[1] == {"joint_spring"}
    assert s.same_torque(["actuator_gain"]) == (frozenset({"actuator_gain"}),)
    assert s.same_torque(["fast_viscous_friction"]) == (frozenset({"viscous_friction"}),)
