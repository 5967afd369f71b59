"""Checks find what was done to a log, say what to do, and leave honest logs alone."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cdia_pin import Dynamics, load_robot
from cdia_pin.app.advice import advice_words
from cdia_pin.effects import parse_term
from cdia_pin.effects.sensing import LATEST
from cdia_pin.errors import LogError
from cdia_pin.logs import Log, check_log, read_log, write_log
from cdia_pin.logs.checks.another_arm import check_arm
from cdia_pin.logs.checks.conventions import CERTAIN, ConventionChange, Conventions, Trial, commonest
from cdia_pin.logs.checks.effort_kind import GravityGain, check_effort_kind, gravity_gains
from cdia_pin.logs.checks.finding import Severity
from cdia_pin.logs.checks.fit import unexplained
from cdia_pin.logs.checks.lag import SPAN, LagEstimate, check_lag
from cdia_pin.logs.checks.limits import check_limits
from cdia_pin.logs.checks.motion import motion_of
from cdia_pin.logs.checks.sampling import quantum
from cdia_pin.logs.checks.stuck import check_stuck
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.logs.reversals import reversals
from tests.one_joint import write_urdf


# folder, robot, gains, below the measured logs
def problems(log, robot):
    return [f for f in check_log(log, robot).problems if f.topic != "limits"]


def columns(log: Log, order) -> Log:
    """The log with the numbers of other joints under each name."""
    order = list(order)
    return replace(
        log, position=log.position[:, order], velocity=log.velocity[:, order], effort=log.effort[:, order]
    )


def turned(log: Log, joint: str, *signals: str) -> Log:
    k = log.joints.index(joint)
    sign = np.where(np.arange(len(log.joints)) == k, -1.0, 1.0)
    return replace(log, **{s: getattr(log, s) * sign for s in signals})


# ---------------------------------------------------------------- honest logs


@pytest.mark.parametrize("name", ["ur5_log", "panda_log"])
def test_a_correct_log_has_no_problem(name, request):
    log = request.getfixturevalue(name)
    robot = request.getfixturevalue(name.removesuffix("_log"))
    check = check_log(log, robot)
    assert check.ok, check.problems
    assert check.about("effort_kind")[0].severity == "ok"
    assert check.about("sign")[0].value["sure"] == list(robot.joints)


@pytest.mark.parametrize("missing", ["payload", "tilt", "friction", "offset", "spring", "ripple", "noise"])
def test_missing_physics_is_not_reported_as_wrong_conventions(ur5, ur5_log, missing):
    log = ur5_log
    q, v, size = log.position, log.velocity, log.effort.std(axis=0)
    weight = np.array([0.0, 0.0, -9.81 * 5.0, 0.0, 0.0, 0.0])
    added = {
        "payload": -np.einsum("nij,i->nj", ur5.tool_jacobian(q), weight),
        "tilt": ur5.gravity_regressor(q) @ np.array([1.5, -1.0, 0.2]),
        "friction": size * (2 * np.tanh(v / 0.01) + v),
        "offset": np.tile([5.0, -3.0, 2.0, 1.0, -1.0, 0.5], (len(q), 1)),
        "spring": size * q,
        "ripple": 0.3 * size * np.sin(20 * q),
        "noise": 0.3 * size * np.random.default_rng(0).normal(size=q.shape),
    }[missing]
    assert problems(replace(log, effort=log.effort + added), ur5) == []


def test_a_check_is_json_with_its_schema(ur5, ur5_log):
    check = check_log(ur5_log, ur5)
    out = json.loads(json.dumps(check.to_dict()))
    assert out["schema"] == "cdia-check/1"
    assert out["ok"] is True
    assert {"topic", "severity", "joint", "message", "advice", "value"} == set(out["findings"][0])


def test_notes_of_the_reader_are_findings(ur5, ur5_log):
    check = check_log(ur5_log.noted("joints renamed"), ur5)
    assert check.about("reading")[0].message == "joints renamed"


def test_a_log_of_another_robot_is_refused(panda, ur5_log):
    with pytest.raises(LogError, match="robot 'panda' has"):
        check_log(ur5_log, panda)


# ---------------------------------------------------------------- units, signs, order


def test_degrees_are_recognised(ur5, ur5_log):
    factor = 180 / np.pi
    log = replace(ur5_log, position=ur5_log.position * factor, velocity=ur5_log.velocity * factor)
    (found,) = problems(log, ur5)
    assert (found.topic, found.severity, found.advice) == ("units", "error", "--convert angle=deg")


def test_degrees_beyond_all_turns_are_degrees_for_the_other_checks_too(ur5, ur5_log):
    weak = replace(ur5_log, position=np.degrees(ur5_log.position), velocity=None, effort=0 * ur5_log.effort)
    noise = np.random.default_rng(0).normal(size=weak.effort.shape)  # no torque tells the unit of the angles
    check = check_log(replace(weak, effort=noise), ur5)
    (found,) = check.about("units")
    assert found.advice == "--convert angle=deg"
    ranges = [f.value["range"] for f in check.about("excitation") if f.joint]
    assert max(ranges) < 2 * np.pi


def test_newton_millimetres_are_recognised(panda, panda_log):
    (found,) = problems(replace(panda_log, effort=1000 * panda_log.effort), panda)
    assert (found.topic, found.severity, found.advice) == ("effort_kind", "error", "--convert torque=Nmm")


def test_currents_in_milliamperes_are_recognised_where_gains_were_applied(panda, panda_log):
    tolerance = np.full(panda.n, 0.1)
    found = problems(replace(panda_log, effort=1000 * panda_log.effort, effort_tolerance=tolerance), panda)
    kind, *rest = [f for f in found if f.topic == "effort_kind"]
    assert not rest
    assert (kind.severity, kind.advice) == ("error", "--convert torque=mA")
    assert not any("Nmm" in f.advice for f in found)


@pytest.mark.parametrize("joint", ["shoulder_pan_joint", "shoulder_lift_joint", "wrist_3_joint"])
def test_an_effort_of_the_wrong_sign_is_found(ur5, ur5_log, joint):
    (found,) = problems(turned(ur5_log, joint, "effort"), ur5)
    assert (found.topic, found.joint) == ("sign", joint)
    assert found.advice == f"--convert flip_effort={joint}"


def test_several_wrong_signs_are_found_together(panda, panda_log):
    (found,) = problems(replace(panda_log, effort=-panda_log.effort), panda)
    assert found.value["joints"] == list(panda.joints)


@pytest.mark.parametrize("signals", [("effort",), ("position", "velocity")])
def test_a_joint_whose_sign_is_wrong_is_not_among_those_whose_sign_is_right(panda, panda_log, signals):
    wrong, *others = panda.joints[3:0:-1]
    error, *more = check_log(turned(panda_log, wrong, *signals), panda).about("sign")
    assert (error.severity, error.joint) == ("error", wrong)
    (rest,) = more
    assert set(others) <= set(rest.value["sure"])
    assert wrong not in rest.message


def test_a_position_of_the_wrong_sign_is_found(panda, panda_log):
    (found,) = problems(turned(panda_log, "panda_joint3", "position", "velocity"), panda)
    assert found.advice == "--convert flip_position=panda_joint3"


def test_of_a_turned_effort_and_a_turned_position_that_fit_alike_the_effort_is_taken():
    conventions = Conventions.assumed(2)
    trials = {
        kind: Trial(kind, (1,), conventions, np.zeros(2), gain)
        for kind, gain in ((ConventionChange.POSITION_SIGN, 3.0), (ConventionChange.EFFORT_SIGN, 2.8))
    }
    position, effort = trials.values()
    assert commonest([position, effort]) is effort
    assert commonest([position, replace(effort, gain=1.0)]) is position  # does not fit well itself
    assert commonest([position, replace(effort, joints=(0,))]) is position  # another joint


def test_the_advice_repairs_the_log(ur5, ur5_log, tmp_path):
    path = write_log(turned(ur5_log, "elbow_joint", "effort"), tmp_path / "x.csv")
    (found,) = problems(read_log(path, ur5), ur5)
    assert problems(read_log(path, ur5, convert=found.advice.removeprefix("--convert ")), ur5) == []


@pytest.mark.parametrize("order", [(2, 1, 0, 3, 4, 5), (5, 0, 1, 2, 3, 4), (1, 2, 0, 3, 4, 5)])
def test_an_exchange_of_joints_is_found_and_the_advice_undoes_it(ur5, ur5_log, order, tmp_path):
    wrong = columns(ur5_log, order)
    (found,) = problems(wrong, ur5)
    assert (found.topic, found.severity) == ("joint_order", "error")
    path = write_log(wrong, tmp_path / "x.csv")
    mended = read_log(path, ur5, joint_map=found.advice.removeprefix("--joint-map "))
    np.testing.assert_array_equal(mended.effort, ur5_log.effort)


def test_efforts_in_another_order_than_positions_are_found(panda, panda_log):
    order = [0, 2, 1, 3, 4, 5, 6]
    (found,) = problems(replace(panda_log, effort=panda_log.effort[:, order]), panda)
    assert found.topic == "joint_order"
    assert "not the positions" in found.message


def test_a_short_log_is_said_to_be_short_and_not_at_rest(ur5, ur5_log):
    check = check_log(ur5_log.slice(0, int(1.5 * ur5_log.rate)), ur5)
    (velocity,) = check.about("velocity")
    assert "too short" in velocity.message


def test_joints_that_move_in_step_are_reported(ur5, ur5_log):
    course = ur5_log.position[:, [0]] - ur5_log.position[0, 0]
    q = ur5_log.position[0] + course * np.linspace(0.5, 1.0, ur5.n)
    log = replace(ur5_log, position=q, velocity=None, effort=ur5.gravity(q))
    (found,) = (f for f in check_log(log, ur5).about("excitation") if f.severity == "warning")
    assert "in step" in found.message
    assert all("in step" not in f.message for f in check_log(ur5_log, ur5).about("excitation"))


def exchanged(log, robot, q):
    """A log of some positions whose columns are exchanged; gravity and friction make its efforts."""
    friction = np.diff(q, axis=0, append=q[-1:]) * log.rate * np.linspace(2.0, 20.0, robot.n)
    right = replace(log, position=q, velocity=q, effort=robot.gravity(q) + friction)
    return replace(columns(right, (2, 1, 0, 3, 4, 5)), velocity=None)


@pytest.mark.parametrize("in_step", [True, False])
def test_joints_in_step_and_single_strokes_prove_no_exchange(ur5, ur5_log, in_step):
    part = np.linspace(0.0, 1.0, len(ur5_log.time))[:, None]
    course = part if in_step else np.clip((part - np.arange(ur5.n) / 12) / 0.5, 0.0, 1.0)
    swing = np.cos((5 if in_step else 1) * np.pi * course)
    log = exchanged(ur5_log, ur5, ur5_log.position[0] + swing * np.linspace(0.3, 0.6, ur5.n))
    orders = check_log(log, ur5).about("joint_order")
    (found,) = (f for f in orders if f.severity == "warning")
    assert "perhaps" in found.message and found.value["gain"] > CERTAIN
    assert all("no exchange" not in f.message for f in orders)


def test_what_cannot_be_determined_is_reported(ur5, ur5_log):
    check = check_log(ur5_log, ur5)
    still = replace(ur5_log, position=ur5_log.position[[0] * 5000], velocity=0 * ur5_log.velocity)
    said = [f.message for f in check_log(still, ur5).findings]
    assert check.ok
    assert any("cannot determine signs" in m for m in said)
    assert any("cannot determine the kind of effort" in m for m in said)
    assert any("cannot determine the lag" in m for m in said)


# ---------------------------------------------------------------- kind of effort


def test_gravity_compensated_efforts_are_recognised(ur5, ur5_log):
    log = replace(ur5_log, effort=ur5_log.effort - ur5.gravity(ur5_log.position))
    (found,) = problems(log, ur5)
    assert "contain no gravity" in found.message
    assert "gravity=compensated" in found.advice


def test_gravity_that_is_as_faint_as_inertia_is_another_unit_and_not_compensated():
    compensated, current = (GravityGain(0.002, 0.025, dynamic, 3.0) for dynamic in (1.1, 0.05))
    assert (compensated.absent, compensated.small) == (True, False)
    assert (current.absent, current.small) == (False, True)


def test_a_gain_of_gravity_is_no_more_certain_than_what_another_motion_shows(tmp_path):
    robot = load_robot(write_urdf("revolute", tmp_path))
    time = np.arange(0.0, 40.0, 0.01)

    def gain(amplitude: float) -> GravityGain:
        """The gain of a swing that repeats, of a joint with a torque that is not in the URDF."""
        q = amplitude * np.sin(2 * np.pi * time / 4)[:, None]
        effort = robot.gravity(q) + 2 * q**2 + 0.5 * np.sign(np.gradient(q, axis=0))
        motion = motion_of(Log(("only",), time, q, effort), robot.is_prismatic)
        assert motion is not None
        return gravity_gains(motion, robot)[0]

    small, large = gain(0.3), gain(2.0)
    assert large.gain - small.gain > 0.2  # [1]; parts of the time alone have errors of 0.002 and 0.02
    assert large.gain - small.gain < 2 * np.hypot(small.error, large.error)


@pytest.mark.parametrize(("factor", "said"), [(0.01, "before a gear"), (0.1, "currents in A")])
def test_motor_side_efforts_and_currents_are_suspected_but_not_proved(ur5, ur5_log, factor, said):
    (found,) = problems(replace(ur5_log, effort=factor * ur5_log.effort), ur5)
    assert found.severity == "warning"
    assert said in found.message
    assert "cannot prove it" in found.message


# ---------------------------------------------------------------- lag


@pytest.mark.parametrize("delay", [0.02, 0.05])
def test_a_late_effort_is_found_with_an_interval_that_covers_the_truth(panda, plant, delay):
    (found,) = problems(plant(panda, delay=delay), panda)
    low, high = found.value["interval_s"]
    assert found.topic == "lag"
    assert low <= delay <= high
    assert "look alike" in found.message


def test_no_delay_is_reported_without_one(ur5, panda, ur5_log, panda_log):
    for robot, log in ((ur5, ur5_log), (panda, panda_log)):
        (found,) = check_log(log, robot).about("lag")
        low, high = found.value["interval_s"]
        assert found.severity == "info"
        assert low <= 0.0 <= high


@pytest.mark.parametrize(("shift", "said"), [(-0.03, "early"), (0.03, "late")])
def test_a_lag_is_early_or_late_and_never_negative(panda, panda_log, shift, said):
    time = panda_log.time
    moved = np.column_stack([np.interp(time - shift, time, effort) for effort in panda_log.effort.T])
    (found,) = check_log(replace(panda_log, effort=moved), panda).about("lag")
    assert re.match(
        rf"the efforts are [\d.]+ ms {said} \(between [\d.]+ ms \w+ and [\d.]+ ms \w+\)", found.message
    )


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [(-0.137, 0.129, "from 100 ms early to 100 ms late"), (-0.03, 0.05, "from 30 ms early to 50 ms late")],
)
def test_a_lag_that_is_not_known_is_between_lags_that_were_tried(monkeypatch, ur5, ur5_log, low, high, said):
    estimate = LagEstimate(0.0, low, high, (0,))
    monkeypatch.setattr("cdia_pin.logs.checks.lag.estimate_lag", lambda *_: estimate)
    (found,) = check_lag(ur5_log, ur5, Conventions.assumed(ur5.n))
    assert said in found.message


def test_gear_ratios_and_drive_gains_that_are_proposed_are_above_zero(ur5, ur5_log):
    gains = {1: GravityGain(0.02, 0.001, 0.02, 3.0), 2: GravityGain(0.01, 0.001, 0.01, 3.0)}
    gains[3] = GravityGain(-0.01, 0.001, 0.01, 1.0)
    (found,) = check_effort_kind(ur5_log, gains)
    assert "--convert reduction=" in found.advice and ":-" not in found.advice


# ---------------------------------------------------------------- velocity


@pytest.mark.parametrize(
    ("change", "advice"),
    [
        (lambda log: turned(log, "elbow_joint", "velocity"), "--convert flip_velocity=elbow_joint"),
        (lambda log: replace(log, velocity=log.velocity * 180 / np.pi), "use_velocity=false"),
        (lambda log: replace(log, velocity=log.velocity * 0.0), "use_velocity=false"),
        (lambda log: replace(log, velocity=log.velocity * 1e3), "--convert time=ms"),
        (lambda log: replace(log, velocity=log.velocity * 1.2), "use_velocity=false"),
        (lambda log: replace(log, velocity=log.velocity[:, ::-1]), "order of the columns"),
    ],
)
def test_velocities_that_are_not_the_derivative_of_positions_are_found(ur5, ur5_log, change, advice):
    found = problems(change(ur5_log), ur5)
    assert {f.topic for f in found} == {"velocity"}
    assert advice in found[0].advice


def test_one_factor_on_all_joints_may_be_the_times(ur5, ur5_log):
    hurried = replace(ur5_log, time=0.2 * ur5_log.time)
    (found,) = (f for f in problems(hurried, ur5) if f.topic == "velocity")
    assert "5 times too fast" in found.message
    assert f"--convert rate={ur5_log.rate:.4g}; otherwise" in found.advice
    ragged = replace(hurried, time=hurried.time + 0.2 / hurried.rate * np.sin(np.arange(len(hurried.time))))
    (found,) = (f for f in problems(ragged, ur5) if f.topic == "velocity")
    assert "multiply its times by 5;" in found.advice
    apart = replace(ur5_log, velocity=ur5_log.velocity * np.linspace(0.2, 0.3, ur5.n))
    (found,) = problems(apart, ur5)
    assert "times run" not in found.message


def test_a_filtered_velocity_is_late(ur5, ur5_log):
    late = np.vstack([ur5_log.velocity[:5], ur5_log.velocity[:-5]])
    (found,) = problems(replace(ur5_log, velocity=late), ur5)
    assert found.value["lag_s"] == pytest.approx(0.02, abs=1e-3)


# ---------------------------------------------------------------- sampling, saturation, excitation


def test_a_gap_is_found_and_only_the_longest_stretch_is_checked(ur5, ur5_log):
    keep = np.r_[0:1000, 1200:5000]
    parts = {s: getattr(ur5_log, s)[keep] for s in ("time", "position", "velocity", "effort")}
    (found,) = problems(replace(ur5_log, **parts), ur5)
    assert found.topic == "gaps"
    assert found.value["longest_s"] == pytest.approx(0.804)


def test_what_is_not_checked_behind_a_gap_is_counted(ur5, ur5_log):
    time = ur5_log.time.copy()
    time[4000:] += 3.0
    (found,) = check_log(replace(ur5_log, time=time), ur5).about("gaps")
    assert "1000 samples" in found.message and found.value["not_checked"] == 1000


def test_a_stretch_in_which_every_signal_stands_still_is_named(ur5, ur5_log):
    held = {s: getattr(ur5_log, s).copy() for s in ("position", "velocity", "effort")}
    for x in held.values():
        x[1000:1100] = x[1000]  # 0.4 s, 2 % of the log
    found, *_ = check_log(replace(ur5_log, **held), ur5).about("frozen")
    assert found.severity == "warning" and found.joint is None
    assert "t = 4 s" in found.message and found.value["seconds"] == pytest.approx(0.396)


def stuck(log: Log, joint: int, start: int, stop: int) -> Log:
    position = log.position.copy()
    position[start:stop, joint] = position[start, joint]
    return replace(log, position=position)


@pytest.mark.parametrize("with_velocity", [True, False])
@pytest.mark.parametrize("joint", range(6))
def test_an_encoder_that_stands_still_alone_is_named(ur5, ur5_log, joint, with_velocity):
    log = stuck(ur5_log if with_velocity else replace(ur5_log, velocity=None), joint, 1000, 1500)
    found = [f for f in check_log(log, ur5).about("frozen") if "jump" in f.value]
    assert [f.joint for f in found] == [ur5.joints[joint]] and found[0].severity == "warning"
    assert found[0].value["from_s"] == 4.0 and found[0].value["seconds"] == pytest.approx(1.996)
    assert found[0].value["jump"] == pytest.approx(
        ur5_log.position[1500, joint] - ur5_log.position[1000, joint]
    )


def test_of_two_stretches_the_longer_one_is_named(ur5, ur5_log):
    log = stuck(stuck(ur5_log, 2, 1000, 1200), 2, 3000, 3500)
    (found,) = [f for f in check_log(log, ur5).about("frozen") if "jump" in f.value]
    assert found.value["from_s"] == 12.0


@given(
    seed=st.integers(0, 2**32 - 1),
    rest=st.integers(50, 2000),
    step=st.sampled_from([0.0, 1e-5, 1e-3, 0.02]),
    rate=st.sampled_from([50.0, 250.0, 1000.0]),
    hold=st.sampled_from([1, 2, 10]),
)
@settings(max_examples=100, deadline=None)
def test_joints_that_rest_and_coarse_encoders_are_not_called_stuck(ur5, seed, rest, step, rate, hold):
    # rests, moves with the acceleration of a smooth step, rests, and moves back; the other joints move on
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0, 1, int(rate * rng.uniform(0.3, 3.0)))
    move = 6 * ramp**5 - 15 * ramp**4 + 10 * ramp**3
    one = np.concatenate([np.zeros(rest), move, np.ones(rest), 1 - move, np.zeros(rest)])
    time = np.arange(len(one)) / rate
    position = np.sin(np.outer(time, rng.uniform(0.5, 2.0, 6)))
    position[:, 2] = rng.uniform(0.2, 2.0) * one
    position = position[np.arange(len(time)) // hold * hold]
    position = np.round(position / step) * step if step else position
    log = Log(ur5.joints, time, position, rng.normal(size=position.shape))
    assert not list(check_stuck(log, ur5))


def test_measured_logs_have_no_encoder_that_stands_still(measured_logs):
    for log, arm in measured_logs:
        for step in (0.0, 1e-4, 1e-3, 0.01):
            position = np.round(log.position / step) * step if step else log.position
            assert not list(check_stuck(replace(log, position=position), arm)), (log.source, step)


def held_until_it_is_back(log: Log, joint: int) -> tuple[Log, float, float]:
    """Hold a position until the joint comes by there again, both times fast; return since when and how long [s] too."""
    q, speed = log.position[:, joint], np.abs(np.gradient(log.position[:, joint], log.time))
    best = (0.0, 0, 0)
    for start in range(100, len(q) - 200, 10):
        ahead = np.s_[start : np.searchsorted(log.time, log.time[start] + 3.0)]
        passed = np.diff(np.sign(q[ahead] - q[start] + 1e-12)) != 0
        for later in np.flatnonzero(passed & (log.time[ahead][:-1] - log.time[start] > 0.3))[:1]:
            stop = start + int(later) + 1
            best = max(best, (min(speed[start], speed[min(stop, len(q) - 200)]), start, stop))
    _, start, stop = best
    return stuck(log, joint, start, stop), float(log.time[start]), float(log.time[stop - 1] - log.time[start])


@pytest.mark.parametrize("with_velocity", [True, False])
@pytest.mark.parametrize("joint", range(6))
def test_an_encoder_that_stands_still_and_is_back_where_it_was_is_named(ur5, ur5_log, joint, with_velocity):
    log, since, seconds = held_until_it_is_back(ur5_log, joint)
    log = log if with_velocity else replace(log, velocity=None)
    (found,) = [f for f in check_log(log, ur5).about("frozen") if "speed_before" in f.value]
    assert found.joint == ur5.joints[joint] and found.severity == "warning"
    assert (found.value["from_s"], found.value["seconds"]) == pytest.approx((since, seconds))
    assert "without slowing down" in found.message and "\n" not in found.message


def test_an_encoder_that_is_back_where_it_was_is_named_in_measured_logs(measured_logs):
    named = []
    for log, arm in measured_logs[:2]:
        for joint in range(arm.n):
            broken, since, _ = held_until_it_is_back(log, joint)
            found = [f for f in check_stuck(broken, arm) if f.joint == log.joints[joint]]
            named.append([f.value["from_s"] for f in found] == [pytest.approx(since, abs=0.01)])
    assert all(named), named


def test_joints_that_stop_abruptly_again_and_again_do_so(ur5):
    # a table of positions: ramps, and rests between them
    ramp, rest = np.linspace(0, 1, 500), np.ones(100)
    one = np.concatenate([ramp, rest, 1 - ramp, 0 * rest] * 3)
    time = np.arange(len(one)) / 250.0
    position = np.sin(np.outer(time, np.arange(1, 7) / 3))
    position[:, 2] = one
    assert not list(check_stuck(Log(ur5.joints, time, position, np.cos(position)), ur5))


@pytest.mark.parametrize("rate", [125.0, 250.0, 500.0, 1000.0])
@pytest.mark.parametrize("dropped", [{700}, {700, 2500}, {700, 701, 2500}])
def test_rows_missing_on_an_exact_grid_are_counted(ur5, ur5_log, rate, dropped):
    keep = [k for k in range(len(ur5_log.time)) if k not in dropped]
    time = np.arange(len(ur5_log.time)) / rate
    parts = {s: getattr(ur5_log, s)[keep] for s in ("position", "velocity", "effort")}
    (found,) = check_log(replace(ur5_log, time=time[keep], **parts), ur5).about("gaps")
    assert found.severity == "info" and found.value["missing_rows"] == len(dropped)
    assert f"{len(dropped)} row" in found.message and f"after t = {699 / rate:.4g} s" in found.message


def test_jitter_is_no_missing_row(ur5, ur5_log):
    time = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.9, len(ur5_log.time))) / 250.0
    (found,) = check_log(replace(ur5_log, time=time), ur5).about("gaps")
    assert found.severity == "ok"


def test_rows_that_come_twice_are_named(ur5, ur5_log):
    copied = {s: getattr(ur5_log, s).copy() for s in ("position", "velocity", "effort")}
    for x in copied.values():
        x[3000:3200] = x[500:700]
    (found,) = check_log(replace(ur5_log, **copied), ur5).about("copied")
    assert found.severity == "warning"
    assert found.value == {"rows": 200, "from_s": 2.0, "again_s": 12.0}


def test_an_arm_at_rest_has_no_copied_rows(ur5, ur5_log):
    still = {s: getattr(ur5_log, s).copy() for s in ("position", "velocity", "effort")}
    for x in still.values():
        x[:1000] = x[1000]
        x[3000:] = x[1000]
    assert not check_log(replace(ur5_log, **still), ur5).about("copied")


def test_a_slow_rate_is_a_problem(ur5, ur5_log):
    parts = {s: getattr(ur5_log, s)[::10] for s in ("time", "position", "velocity", "effort")}
    assert "rate" in {f.topic for f in problems(replace(ur5_log, **parts), ur5)}


def test_repeated_samples_give_the_rate_of_the_source(ur5, ur5_log):
    held = {s: np.repeat(getattr(ur5_log, s)[::2], 2, axis=0) for s in ("position", "velocity", "effort")}
    (found,) = check_log(replace(ur5_log, **held), ur5).about("duplicates")
    assert found.value["source_rate_hz"] == pytest.approx(125.0, rel=0.01)


@pytest.mark.parametrize("constant", [slice(1000, 1400), slice(None)])
def test_an_effort_that_stops_changing_is_found(ur5, ur5_log, constant):
    effort = ur5_log.effort.copy()
    effort[constant, 1] = effort[1000, 1]
    found = problems(replace(ur5_log, effort=effort), ur5)
    assert ("frozen", "shoulder_lift_joint") in {(f.topic, f.joint) for f in found}


def test_clipped_efforts_are_found_and_plain_peaks_are_not(ur5, ur5_log):
    bound = 0.8 * np.abs(ur5_log.effort[:, 2]).max()
    effort = ur5_log.effort.copy()
    effort[:, 2] = np.clip(effort[:, 2], -bound, bound)
    (found,) = problems(replace(ur5_log, effort=effort), ur5)
    assert (found.topic, found.joint) == ("saturation", "elbow_joint")
    assert found.value["level"] == pytest.approx(bound)
    rounded = replace(ur5_log, effort=np.round(ur5_log.effort, 1))
    assert not [f for f in problems(rounded, ur5) if f.topic == "saturation"]


@pytest.mark.parametrize(("beyond", "count"), [(1.01, 1), (1.06, 0)])
def test_an_effort_that_exceeds_its_limit_is_not_clipped_there(ur5, ur5_log, beyond, count):
    effort = ur5_log.effort.copy()
    effort[:, 2] *= beyond * ur5.limits.effort[2] / np.abs(effort[:, 2]).max()
    found = check_log(replace(ur5_log, effort=effort), ur5).about("saturation")
    assert len([f for f in found if f.joint == "elbow_joint"]) == count


def test_a_late_row_is_not_missing(ur5, ur5_log):
    time = ur5_log.time.copy()
    time[1000] += 0.7 * (time[1] - time[0])
    assert check_log(replace(ur5_log, time=time), ur5).about("gaps")[0].message == "no gaps"


@pytest.mark.parametrize("step", [1e-4, 1e-3, 0.0357])
def test_the_step_of_rounded_positions_is_measured(ur5_log, step):
    assert quantum(step * np.round(ur5_log.position[:, 0] / step)) == pytest.approx(step)


def test_continuous_positions_have_no_step(ur5_log):
    assert quantum(ur5_log.position[:, 0]) == 0.0
    assert quantum(np.linspace(0.0, 1.0, 1000)) == 0.0


def test_excitation_reports_what_is_not_identifiable_for_each_joint(ur5, ur5_log):
    position = ur5_log.position.copy()
    position[:, 5] = 0.3
    position[:, 4] = np.linspace(-1.0, 1.0, len(position))
    check = check_log(replace(ur5_log, position=position, velocity=None), ur5)
    said = {f.joint: f.message for f in check.about("excitation")}
    assert "does not move" in said["wrist_3_joint"]
    assert "one way only" in said["wrist_2_joint"]
    assert "one speed only" in said["wrist_2_joint"]
    assert "one way" not in said["elbow_joint"]


def test_positions_beyond_the_limits_are_named(ur5, ur5_log):
    position = ur5_log.position.copy()
    position[:, 2] += 4.0
    found = check_log(replace(ur5_log, position=position), ur5).about("limits")[0]
    assert (found.severity, found.joint) == ("warning", "elbow_joint")


@pytest.mark.parametrize("count", [2, 3, 10, 200, 520])
def test_short_logs_are_checked_without_numpy_warnings(ur5, ur5_log, count, recwarn):
    check_log(ur5_log.slice(0, count), ur5)
    assert not recwarn.list


@pytest.mark.parametrize("step", [0.4, 40.0])
def test_logs_full_of_gaps_are_checked(ur5, ur5_log, step):
    steps = np.where(np.random.default_rng(0).random(5000) < 0.2, step, 0.001)
    check = check_log(replace(ur5_log, time=np.cumsum(steps)), ur5)
    assert check.about("gaps")[0].severity == "warning"


# ---------------------------------------------------------------- what stands in the way of a search


def test_errors_stand_in_the_way_of_a_search_and_warnings_do_not(ur5, ur5_log):
    assert check_log(ur5_log, ur5).mend == ""
    wrong = check_log(turned(ur5_log, "elbow_joint", "effort"), ur5)
    assert [f.topic for f in wrong.obstacles] == ["sign"]
    assert wrong.mend.endswith("add --convert flip_effort=elbow_joint")


def test_a_wrong_velocity_does_not_mislead_a_search_but_wrong_times_do(ur5, ur5_log):
    flipped = check_log(turned(ur5_log, "elbow_joint", "velocity"), ur5)
    assert flipped.problems
    assert not flipped.obstacles
    late = check_log(replace(ur5_log, velocity=ur5_log.velocity * 1e3), ur5)
    assert late.mend.endswith("--convert time=ms")


# ---------------------------------------------------------------- another arm


def small_arm_log(robot, arm, log):
    """What a log of an arm would be if it were driven along the motion of another."""
    made = log.position, log.velocity, np.gradient(log.velocity, 1 / log.rate, axis=0)
    effort = arm.inverse_dynamics(*made) + 0.02 * np.tanh(log.velocity / 0.01) * log.effort.std(axis=0)
    return replace(log, effort=effort, joints=robot.joints)


@pytest.mark.parametrize("name", ["ur3", "ur10"])
def test_a_log_of_another_bundled_arm_is_named(ur5, ur5_log, name):
    (found,) = check_log(small_arm_log(ur5, load_robot(name), ur5_log), ur5).about("robot")
    assert (found.severity, found.value["best"]) == ("warning", name)
    assert found.advice.startswith(f"--robot {name}")


def test_an_arm_is_named_though_another_gain_would_do_as_well(ur5_log):
    """A small arm of the same maker, times a gain that no unit has, has nearly the torques of the large one."""
    ur3 = load_robot("ur3")
    (found,) = check_log(small_arm_log(ur3, load_robot("ur10"), ur5_log), ur3).about("robot")
    assert found.value["best"] == "ur10"
    assert "check the unit" in found.advice


def test_another_unit_is_not_another_arm(ur5, ur5_log):
    for factor in (100.0, 1000.0):  # N·cm, N·mm
        check = check_log(replace(ur5_log, effort=factor * ur5_log.effort), ur5)
        assert not check.about("robot")


def before_its_gears(log):
    """The log with the torques of the motors: friction and some inertia, and gravity that a spring carries."""
    ratios = np.array([160.0, 270.0, 250.0, 90.0, 120.0, 60.0])
    speed = np.gradient(log.position, 1 / log.rate, axis=0)
    rng = np.random.default_rng(3)
    noise = 0.02 * rng.standard_normal(log.effort.shape)
    friction = log.effort.std(axis=0).max() * (np.tanh(speed / 0.01) + 0.3 * speed)
    return replace(log, effort=(0.02 * log.effort + friction) / ratios + noise)


def test_torques_before_the_gears_are_those_of_the_motors_and_not_of_a_small_arm(ur5_log):
    large = load_robot("ur10")
    check = check_log(replace(before_its_gears(ur5_log), joints=large.joints), large)
    assert not check.about("robot")
    (found,) = [f for f in check.about("effort_kind") if f.severity == "warning"]
    assert "before the gears" in found.message
    assert "reduction=" in found.advice
    assert advice_words(found.advice).startswith(
        "if it is motor torque, give the gear ratios of the data sheet; "
    )


def test_friction_alone_makes_no_small_arm_likely(ur5_log):
    """A small arm needs so little torque beside this friction that any would do."""
    large = load_robot("ur10")
    speed = np.gradient(ur5_log.position, 1 / ur5_log.rate, axis=0)
    noise = np.random.default_rng(3).standard_normal(speed.shape)
    log = replace(ur5_log, effort=15 * np.tanh(speed / 0.01) + 5 * speed + noise, joints=large.joints)
    assert not check_log(log, large).about("robot")


def test_shares_too_large_for_percents_are_factors(ur5, ur5_log):
    log = small_arm_log(ur5, load_robot("ur3"), ur5_log)
    heavy = motion_of(replace(log, effort=0.02 * log.effort), ur5.is_prismatic)
    plain = motion_of(log, ur5.is_prismatic)
    (found,) = check_arm(ur5, heavy, plain, {})
    assert "times their variance" in found.message
    assert len(re.findall(r"\d+%", found.message)) == 1


def test_a_heavy_payload_is_not_another_arm(ur5, ur5_log):
    loaded = Dynamics(ur5, (parse_term("payload: mass=8, first_moment_z=0.8"),))
    made = ur5_log.position, ur5_log.velocity, np.gradient(ur5_log.velocity, 1 / ur5_log.rate, axis=0)
    check = check_log(replace(ur5_log, effort=loaded.inverse_dynamics(*made)), ur5)
    assert not check.about("robot")


# ---------------------------------------------------------------- arms of one joint, joints without limits


@pytest.fixture
def wheel(tmp_path):
    return load_robot(str(write_urdf("continuous", tmp_path)))


def test_an_arm_of_one_joint_has_no_order_to_determine(wheel, plant):
    check = check_log(plant(wheel), wheel)
    assert check.ok
    assert not check.about("joint_order")


@pytest.mark.parametrize(("kind", "unit"), [("prismatic", "length=mm"), ("revolute", "angle=deg")])
def test_positions_beyond_a_limit_may_have_the_other_unit_of_their_joint(tmp_path, plant, kind, unit):
    arm = load_robot(str(write_urdf(kind, tmp_path)))
    log = plant(arm)
    (found,) = check_limits(replace(log, position=1000 * log.position, velocity=None), arm)
    assert f"--convert {unit}," in found.advice
    # no slide leaves its range so far; angles may be many turns, and their size is judged apart
    assert found.severity is (Severity.ERROR if kind == "prismatic" else Severity.WARNING)


def test_several_turns_of_a_joint_without_limits_are_not_degrees(wheel, plant):
    log = plant(wheel)
    q, v = 12 * log.position, 12 * log.velocity
    noise = np.random.default_rng(0).normal(size=q.shape)  # no torque tells the unit of the angle
    for effort in (wheel.inverse_dynamics(q, v, 0 * q), noise):
        assert not check_log(replace(log, position=q, velocity=v, effort=effort), wheel).about("units")


def test_a_fast_joint_without_limits_is_not_in_degrees_unless_torques_say_so(tmp_path, plant):
    urdf = write_urdf("continuous", tmp_path)
    slow = (
        '<axis xyz="0 1 0"/><limit effort="60" velocity="0.5"/>'  # a limit of speed that somebody put there
    )
    urdf.write_text(urdf.read_text().replace('<axis xyz="0 1 0"/>', slow))
    wheel = load_robot(str(urdf))
    log = plant(wheel)
    q, v = 12 * log.position, 12 * log.velocity
    noise = np.random.default_rng(0).normal(size=q.shape)
    assert not check_log(replace(log, position=q, velocity=v, effort=noise), wheel).about("units")


def test_a_velocity_later_than_any_that_is_tried_is_said_to_be_so(ur5, ur5_log):
    late = np.column_stack([np.interp(ur5_log.time - 0.18, ur5_log.time, v) for v in ur5_log.velocity.T])
    messages = [f.message for f in check_log(replace(ur5_log, velocity=late), ur5).about("velocity")]
    assert any("100 ms or more late" in m for m in messages), messages


def test_several_axes_that_may_be_reversed_have_a_plural(ur5):
    from types import SimpleNamespace

    from cdia_pin.logs.checks.conventions import ConventionChange
    from cdia_pin.logs.checks.sign_and_order import _signs

    def said(*axes):
        rest = [SimpleNamespace(joints=(k,), kind=ConventionChange.BOTH_SIGNS, gain=0.0) for k in axes]
        same = Conventions.assumed(ur5.n)
        search = SimpleNamespace(rest=rest, start=same, conventions=same)
        (found,) = _signs(SimpleNamespace(joints=ur5.joints), ur5, search)
        return found.message

    assert "elbow_joint is reversed" in said(2)
    assert "elbow_joint, wrist_3_joint are each reversed" in said(2, 5)


def test_the_check_tries_all_delays_that_a_search_may_find():
    assert SPAN == LATEST


@pytest.mark.parametrize("value", ["zeros", "last row"])
def test_an_end_in_which_nothing_was_measured_is_said_and_left_out(ur5, ur5_log, value):
    rows = len(ur5_log.time)
    first = next(
        k
        for k in range(rows // 2, rows)
        if np.abs(np.diff(ur5_log.position[k - 1 : k + 1], axis=0)).max() > 0
    )
    ended = {}
    for name in ("position", "effort"):
        signal = getattr(ur5_log, name).copy()
        signal[first:] = 0.0 if value == "zeros" else signal[first]
        ended[name] = signal
    log = replace(ur5_log, **ended, velocity=None)
    found = check_log(log, ur5)
    (frozen,) = [f for f in found.about("frozen") if f.joint is None]
    assert "left out of all that is computed" in frozen.advice
    whole = check_log(replace(ur5_log, velocity=None).slice(0, first), ur5)
    assert [f for f in found.findings if f is not frozen and f.topic not in {"rate", "gaps", "jitter"}] == [
        f for f in whole.findings if f.topic not in {"rate", "gaps", "jitter"}
    ]
    motion = condition(log, ur5)
    assert motion.time[-1] < ur5_log.time[first]
    assert any("stands still for the last" in note for note in motion.record["notes"])


def test_a_joint_whose_drive_is_off_gets_no_sign(ur5, ur5_log):
    rng = np.random.default_rng(0)
    k = ur5.joint_index("elbow_joint")
    slope = -0.02 * np.gradient(
        ur5_log.position[:, k], ur5_log.time
    )  # what a drive at rest reads against the motion
    effort = ur5_log.effort.copy()
    effort[:, k] = slope + 0.01 * rng.standard_normal(len(slope))
    found = check_log(replace(ur5_log, effort=effort), ur5)
    (off,) = [f for f in found.about("effort_kind") if "drive is off" in f.message]
    assert off.joint == "elbow_joint" and off.severity == "warning"
    assert not found.obstacles
    assert all("elbow_joint" not in f.message for f in found.about("sign"))


def test_motor_currents_are_no_drive_that_is_off(measured_logs):
    for log, arm in measured_logs:
        for factor in (1.0, 0.1):  # currents in A are a tenth of the torque
            found = check_log(replace(log, effort=factor * log.effort), arm)
            assert not [f for f in found.about("effort_kind") if "drive is off" in f.message]


def test_an_effort_of_another_joint_is_not_seen_in_few_postures():
    few = np.repeat([0.1, 0.5, 0.9, 0.4], 100)  # four postures
    rng = np.random.default_rng(0)
    inside = 0.01 * rng.standard_normal(400)
    effort = few + inside  # follows a column from posture to posture alone
    columns = (few + 0.01 * rng.standard_normal(400))[:, None]
    assert unexplained(effort, columns) < 0.01
    assert unexplained(effort, columns, parts=4) > 0.9


# ---------------------------------------------------------------- coarse encoders, gravity that hardly varies


def test_steps_of_an_encoder_are_no_reversals():
    time = np.arange(0.0, 60.0, 0.02)
    place = 0.3 * np.sin(2 * np.pi * time / 25.0)  # slow: five turns
    steps = np.round(place / 0.0015) * 0.0015
    v = np.gradient(zero_phase(steps[:, None], 8.0, 50.0)[:, 0], 0.02)
    assert np.sum(np.diff(np.sign(v)) != 0) > 50
    assert reversals(v) == reversals(np.gradient(place)) == 5


def test_a_joint_that_never_turns_has_no_reversal():
    assert reversals(np.ones(100)) == reversals(np.zeros(100)) == reversals(np.zeros(0)) == 0


@pytest.mark.parametrize(("swing", "known"), [(0.05, False), (1.2, True)])
def test_a_gain_of_gravity_that_hardly_varies_is_not_known(tmp_path, swing, known):
    """A gain and an offset cancel in what the joint carries, and both fit the effort alike."""
    robot = load_robot(write_urdf("revolute", tmp_path))
    time = np.arange(0.0, 40.0, 0.01)
    q = 0.2 + swing * np.sin(2 * np.pi * time / 4)[:, None]
    weight = robot.gravity(q)
    motion = motion_of(Log(("only",), time, q, 2.0 * weight - 1.5 * weight.mean()), robot.is_prismatic)
    found = gravity_gains(motion, robot)[0]
    assert found.gain == pytest.approx(2.0, rel=0.05)
    assert found.known is known
