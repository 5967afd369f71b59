"""Which samples can be: spikes are dropped, shifts are found, dead sensors are named, and good data pass."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cdia_pin import Log, load_robot
from cdia_pin.diagnosis import sample_rows as rows
from cdia_pin.diagnosis.sample_bounds import SampleBounds
from cdia_pin.diagnosis.sample_check import Outcome, SampleCheck

ROBOT = load_robot("ur5")
N, TICK = ROBOT.n, 1e-3
PASSED = {Outcome.ACCEPTED, Outcome.BRIDGED, Outcome.RESTARTED}


def motion(seconds, seed=0, velocity=True):
    """A smooth motion of all joints with the noise of usual sensors; torques follow it."""
    rng, t = np.random.default_rng(seed), np.arange(round(seconds / TICK)) * TICK
    rates = 0.5 + 0.2 * np.arange(N)
    phase = rates * t[:, None] + np.arange(N)
    q, v = 0.6 * np.sin(phase), 0.6 * rates * np.cos(phase)
    tau = 20 * np.cos(phase) + 0.05 * rng.standard_normal(q.shape)
    v = v + 1e-3 * rng.standard_normal(q.shape) if velocity else None
    return Log(ROBOT.joints, t, 2e-5 * np.rint(q / 2e-5), tau, v)


LEARNED = SampleBounds.learned(ROBOT, [motion(10.0)])


def check(velocity=True):
    bounds = LEARNED if velocity else SampleBounds.learned(ROBOT, [motion(10.0, velocity=False)])
    return SampleCheck(ROBOT.joints, bounds, velocity)


def signals(seconds, seed=1, velocity=True):
    log = motion(seconds, seed, velocity)
    return [
        log.time.copy(),
        log.position.copy(),
        None if not velocity else log.velocity.copy(),
        log.effort.copy(),
    ]


def feed(checked, t, q, v, tau):
    """Outcomes, and all events."""
    outcomes, news = [], []
    for k in range(len(t)):
        outcomes.append(checked(float(t[k]), q[k], None if v is None else v[k], tau[k]))
        news += checked.news
    return outcomes, news


@pytest.mark.parametrize(("joints", "is_said"), [(N, True), (1, False), (0, False)])
def test_a_log_that_was_filtered_less_on_all_joints_is_said(joints, is_said):
    log = motion(5.0, seed=2)
    log.effort[:, :joints] += 3.0 * np.random.default_rng(5).standard_normal((len(log.time), joints))
    assert ("filtered otherwise" in LEARNED.rougher(log)) == is_said


@pytest.mark.parametrize("velocity", [True, False])
def test_good_samples_pass(velocity):
    checked = check(velocity)
    outcomes, news = feed(checked, *signals(5.0, velocity=velocity))
    assert set(outcomes) == {Outcome.ACCEPTED}
    assert not news
    assert not checked.faults


def test_times_that_are_off_do_not_accuse_encoders():
    s, checked = signals(2.0), check()
    s[0][500:1000] += np.random.default_rng(5).uniform(-0.4, 0.4, 500) * TICK
    outcomes, _ = feed(checked, *s)
    assert checked.faults == ()
    assert outcomes[500:1000].count(Outcome.BAD) < 50
    assert outcomes[-1] is Outcome.ACCEPTED


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e200, 100.0, -1e6])
@pytest.mark.parametrize("signal", [1, 2, 3])
def test_an_absurd_value_is_dropped_and_the_next_sample_is_good(signal, value):
    s = signals(1.0)
    s[signal][500, 2] = -1e6 if signal == 3 and value == 100.0 else value
    outcomes, news = feed(check(), *s)
    assert outcomes[500] is Outcome.BAD
    assert outcomes[501] is Outcome.BRIDGED
    assert set(outcomes[502:]) == {Outcome.ACCEPTED}
    assert [e.stage for e in news] == ["accommodation"]
    assert ROBOT.joints[2] in news[0].reason


@pytest.mark.parametrize(
    ("signal", "step", "dropped"),
    [(1, 1e-3, Outcome.BAD), (2, 0.5, Outcome.BAD), (3, 30.0, Outcome.HELD)],
)
def test_a_step_that_no_acceleration_makes_is_dropped(signal, step, dropped):
    s = signals(1.0)
    s[signal][500, 2] += step
    outcomes, _ = feed(check(), *s)
    assert outcomes[500] is dropped
    assert outcomes[501] is Outcome.BRIDGED


def test_a_step_of_the_torque_that_stays_is_accepted_with_the_next_sample():
    s = signals(1.0)
    s[3][500:, 2] += 30.0
    outcomes, news = feed(check(), *s)
    assert outcomes[500] is Outcome.HELD
    assert outcomes[501] is Outcome.BRIDGED
    assert set(outcomes[502:]) == {Outcome.ACCEPTED}
    assert not news


def test_steps_of_the_torque_that_were_commanded_pass():
    """A controller that answers a shaken arm by steps is no bad sensor; what was not commanded is one still."""
    s, checked, outcomes = signals(1.0), check(), []
    steps = 20.0 * np.random.default_rng(4).standard_normal(200)
    s[3][500:700, 2] += steps
    s[3][600, 3] += 30.0
    for k in range(len(s[0])):
        outcomes.append(checked(float(s[0][k]), s[1][k], s[2][k], s[3][k]))
        if k + 1 < len(s[0]):
            checked.commands.append(s[3][k + 1] * (np.arange(N) != 3))
    assert outcomes[600] is Outcome.HELD
    assert outcomes[601] is Outcome.BRIDGED
    assert set(outcomes[:600] + outcomes[602:]) == {Outcome.ACCEPTED}


def test_a_torque_sensor_that_dies_passes_nothing_on():
    s, checked = signals(1.0), check()
    s[3][500:, 0] = 0.0
    assert abs(s[3][499, 0]) > 1.0
    outcomes, _ = feed(checked, *s)
    assert not PASSED & set(outcomes[500:])
    (fault,) = checked.faults
    assert (fault.joint, fault.signal, fault.condition) == (ROBOT.joints[0], "torque", "frozen")


@pytest.mark.parametrize("ticks", [4, 10])
def test_a_spike_is_bridged_where_torques_are_held_between_updates(ticks):
    """Joint by joint at other ticks, so that in each tick the torque of some joint repeats itself."""

    def held(log):
        out = log.effort.copy()
        for j in range(N):
            out[:, j] = out[np.maximum((np.arange(len(out)) - j) // ticks * ticks + j, 0), j]
        return Log(ROBOT.joints, log.time, log.position, out, log.velocity)

    checked = SampleCheck(ROBOT.joints, SampleBounds.learned(ROBOT, [held(motion(10.0))]), True)
    log = held(motion(1.0, 1))
    log.position[500, 2] += 0.1
    outcomes, _ = feed(checked, log.time, log.position, log.velocity, log.effort)
    assert outcomes[500] is Outcome.BAD
    assert outcomes[501] is Outcome.BRIDGED
    assert set(outcomes[:500] + outcomes[502:]) == {Outcome.ACCEPTED}


@pytest.mark.parametrize("t", [np.nan, np.inf, 1e200, 0.3, 0.499, 100.0])
def test_a_time_that_cannot_be_is_dropped(t):
    s = signals(1.0)
    s[0][500] = t
    outcomes, _ = feed(check(), *s)
    assert outcomes[500] is Outcome.BAD
    assert outcomes[501] is Outcome.BRIDGED


def test_among_many_spikes_nothing_is_trusted_until_they_end():
    s = signals(1.0)
    s[3][500:700:2, 2] += 30.0
    outcomes, _ = feed(check(), *s)
    assert set(outcomes[530:700]) == {Outcome.BAD}
    assert Outcome.RESTARTED in outcomes[790:810]
    assert outcomes[-1] is Outcome.ACCEPTED


@pytest.mark.parametrize(("signal", "size"), [(2, 0.3), (3, 8.0)])
def test_of_a_burst_of_noise_hardly_a_sample_passes_by_chance(signal, size):
    passed = []
    for seed in range(8):
        s = signals(1.0)
        s[signal][500:700, 2] += size * np.random.default_rng(seed).standard_normal(200)
        outcomes, _ = feed(check(), *s)
        passed.append(sum(o in PASSED for o in outcomes[500:700]))
        assert outcomes[-1] is Outcome.ACCEPTED
    assert np.mean(passed) <= 2  # of 200


@pytest.mark.parametrize("shift", [-100.0, 1000.0])
def test_a_clock_that_is_set_is_followed(shift):
    s = signals(1.0)
    s[0][500:] += shift
    checked = check()
    outcomes, _ = feed(checked, *s)
    assert outcomes[500] is Outcome.BAD
    assert outcomes.count(Outcome.RESTARTED) == 1
    assert outcomes.index(Outcome.RESTARTED) < 620
    assert outcomes[-1] is Outcome.ACCEPTED


def test_an_encoder_that_shifts_is_named_and_the_shift_is_known():
    s, checked = signals(2.0), check()
    s[1][500:, 2] += 0.05
    outcomes, news = feed(checked, *s)
    assert outcomes[-1] is Outcome.ACCEPTED
    (fault,) = checked.faults
    assert (fault.joint, fault.signal, fault.condition) == (ROBOT.joints[2], "position", "shifted")
    assert fault.offset == pytest.approx(0.05, abs=1e-3)
    np.testing.assert_allclose(checked.offset, [0, 0, 0.05, 0, 0, 0], atol=1e-3)
    assert [e.stage for e in news] == ["accommodation", "sensor"]


def test_an_encoder_that_shifts_back_is_sound_again():
    s, checked = signals(2.0), check()
    s[1][500:1200, 2] += 0.05
    feed(checked, *s)
    assert checked.faults == ()
    assert checked.offset is None


@pytest.mark.parametrize(("signal", "name"), [(1, "position"), (2, "velocity"), (3, "torque")])
def test_a_frozen_signal_accuses_its_sensor_until_it_moves_again(signal, name):
    s, checked = signals(3.0), check()
    s[signal][500:1500, 0] = s[signal][500, 0]
    begin = [x[:1400] for x in s]
    outcomes, _ = feed(checked, *begin)
    (fault,) = checked.faults
    assert (fault.joint, fault.signal, fault.condition) == (ROBOT.joints[0], name, "frozen")
    assert Outcome.BAD in outcomes[500:560]
    outcomes, news = feed(checked, *(x[1400:] for x in s))
    assert checked.faults == ()
    assert outcomes[-1] is Outcome.ACCEPTED
    assert any("trusted again" in e.reason for e in news)


def test_a_joint_at_rest_is_not_frozen():
    s, checked = signals(2.0), check()
    s[1][:, 2] = s[1][0, 2]
    s[2][:, 2] = 1e-5 * np.random.default_rng(3).standard_normal(len(s[0]))
    outcomes, _ = feed(checked, *s)
    assert set(outcomes) == {Outcome.ACCEPTED}


def test_a_biased_velocity_contradicts_the_positions():
    s, checked = signals(2.0), check()
    s[2][500:, 2] += 0.3
    feed(checked, *s)
    (fault,) = checked.faults
    assert (fault.joint, fault.signal) == (ROBOT.joints[2], "velocity")


def test_a_collision_is_not_a_fault_of_a_sensor():
    """The velocity turns within a tick, and the position with it: too fast for any drive, and yet the truth."""
    s, checked = signals(2.0), check()
    t = s[0][1000:] - s[0][1000]
    s[2][1000:, 0] -= 0.9
    s[1][1000:, 0] -= 0.9 * (t + 0.5 * TICK)
    outcomes, _ = feed(checked, *s)
    assert checked.faults == ()
    assert Outcome.ACCEPTED in outcomes[1000:1120]


def test_bad_first_samples_do_not_make_the_good_ones_bad():
    s, checked = signals(1.0), check()
    s[1][0] += 1.0
    outcomes, _ = feed(checked, *s)
    assert outcomes[-1] is Outcome.ACCEPTED
    assert checked.faults == ()


@settings(max_examples=30, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(200, 400), st.integers(0, 3), st.integers(0, N - 1), st.floats(width=64)),
        min_size=1,
        max_size=20,
    )
)
def test_whatever_was_in_the_samples_good_ones_pass_afterwards(spoiled):
    s, checked = signals(1.0), check()
    for k, signal, j, value in spoiled:
        if signal:
            s[signal][k, j] = value
        else:
            s[0][k] = value
    outcomes, _ = feed(checked, *s)
    assert set(outcomes[550:]) == {Outcome.ACCEPTED}
    assert checked.faults == ()


def test_coarse_velocities_that_are_all_zero_at_times_are_good():
    """Steps of 0.28 rad/s: all joints of a slow arm read zero at once, from one step up."""

    def coarse(seed):
        log = motion(10.0, seed)
        step = 0.28
        slow = Log(
            log.joints, 4 * log.time, log.position, log.effort, step * np.rint(log.velocity / 4 / step)
        )
        return slow, (slow.velocity == 0.0).all(axis=1)

    healthy, zeros = coarse(0)
    assert zeros.any() and not zeros.all()
    checked = SampleCheck(ROBOT.joints, SampleBounds.learned(ROBOT, [healthy]), True)
    log, zeros = coarse(1)
    assert zeros[1:][~zeros[:-1]].any()  # it goes to zero from one step
    outcomes, news = feed(checked, log.time, log.position, log.velocity, log.effort)
    assert Outcome.BAD not in outcomes
    assert not news


@pytest.mark.parametrize("velocity", [True, False])
def test_a_joint_that_rested_in_the_healthy_runs_may_move(velocity):
    """A joint at rest shows neither how fast it is nor how it accelerates."""
    still = motion(10.0, velocity=velocity)
    still.position[:, 2] = 1e-6 * (np.random.default_rng(2).random(len(still.time)) > 0.99)
    if velocity:
        still.velocity[:, 2] = 1e-5 * np.random.default_rng(3).standard_normal(len(still.time))
    checked = SampleCheck(ROBOT.joints, SampleBounds.learned(ROBOT, [still]), velocity)
    log = motion(5.0, 1, velocity)
    log.position[:, 2] = 2e-5 * np.rint(0.3 * np.sin(4 * log.time) / 2e-5)
    if velocity:
        log.velocity[:, 2] = 1.2 * np.cos(4 * log.time)
    outcomes, news = feed(checked, log.time, log.position, log.velocity, log.effort)
    assert Outcome.BAD not in outcomes[5:]  # it sets off at its full speed
    assert not [n for n in news if "jumped" in str(n)]


def test_of_a_joint_that_rested_position_and_torque_are_known():
    """Beyond the URDF's limit, as a calibrated zero may be; and its torque must not stay the same."""
    still = motion(10.0)
    still.position[:, 2], still.velocity[:, 2] = 4.0, 0.0
    bounds = SampleBounds.learned(ROBOT, [still])
    checked = SampleCheck(ROBOT.joints, bounds, True)
    outcomes, _ = feed(checked, still.time, still.position, still.velocity, still.effort)
    assert Outcome.BAD not in outcomes
    moving = SampleBounds.learned(ROBOT, [motion(10.0)]).array[:, 2]
    assert moving[rows.TORQUE_SLACK] <= bounds.array[rows.TORQUE_SLACK, 2] < 0.05 * ROBOT.limits.effort[2]
    for row in (rows.HOLD_TORQUE, rows.STRONGEST):
        assert bounds.array[row, 2] == pytest.approx(moving[row], rel=0.2)
