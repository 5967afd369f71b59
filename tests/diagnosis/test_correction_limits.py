"""What is added to a nominal torque is bounded, whatever an engine asks for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cdia_pin import Dynamics, load_robot
from cdia_pin.diagnosis import Monitor, correction_kernel, sample_kernel
from cdia_pin.diagnosis.correction_limits import POWER_SHARE, RAMP_TIME, RISE_TIME, CorrectionLimits

EFFORT, SPEED, TICK = np.array([50.0, 10.0]), np.array([3.0, 2.0]), 1e-3
RAMP = round(RAMP_TIME / TICK)
anything = st.floats(allow_nan=True, allow_infinity=True)


def ready():
    limits = CorrectionLimits(EFFORT, SPEED, TICK)
    for _ in range(RAMP):
        limits.tick(TICK, True, None)
    return limits


def settled(limits, asked, ticks=100, trusted=True, velocity=None):
    for _ in range(ticks):
        limits.tick(TICK, trusted, velocity)
        added = limits(np.array(asked))
    return added


@given(st.lists(st.tuples(anything, anything, st.booleans()), min_size=1, max_size=30))
def test_whatever_is_asked_the_torque_is_finite_and_within_effort_and_rate(asked):
    limits, before = ready(), np.zeros(2)
    for one, two, trusted in asked:
        limits.tick(TICK, trusted, None)
        added = limits(np.array([one, two]))
        assert np.isfinite(added).all()
        assert (np.abs(added) <= EFFORT).all()
        assert (np.abs(added - before) <= EFFORT * TICK / RISE_TIME + 1e-9).all()
        before = added


def test_a_usual_correction_is_let_through():
    np.testing.assert_array_equal(settled(ready(), [20.0, -4.0]), [20.0, -4.0])


def test_a_correction_that_pushes_is_bounded_in_power_and_one_that_brakes_is_not():
    velocity = np.array([2.0, -1.9])
    added = settled(ready(), [50.0, 10.0], velocity=velocity)
    assert added[0] * velocity[0] == pytest.approx(POWER_SHARE * EFFORT[0] * SPEED[0])
    assert added[1] == 10.0


def test_it_is_faded_in_and_out():
    limits = CorrectionLimits(EFFORT, SPEED, TICK)
    sizes = []
    for k in range(3 * RAMP):
        limits.tick(TICK, k < 2 * RAMP, None)
        sizes.append(limits(np.array([1.0, 0.0]))[0])
    assert sizes[RAMP // 2] == pytest.approx(0.5, abs=0.02)
    assert sizes[RAMP] == pytest.approx(1.0)
    assert sizes[2 * RAMP + RAMP // 2] == pytest.approx(0.5, abs=0.02)
    assert sizes[-1] == 0.0


def test_a_veto_fades_it_out_and_stays_through_a_reset():
    limits = ready()
    limits.is_wanted = False
    assert not settled(limits, [1.0, 1.0]).any()
    limits.reset()
    assert not settled(limits, [1.0, 1.0], 2 * RAMP).any()
    limits.is_wanted = True
    assert settled(limits, [1.0, 1.0], RAMP + 1).all()


def test_after_a_gap_nothing_of_an_old_correction_is_left():
    limits = ready()
    assert settled(limits, [1.0, 1.0]).all()
    limits.tick(1.0, False, None)
    assert not limits(np.ones(2)).any()


def test_an_unknown_effort_limit_leaves_the_torque_finite():
    limits = CorrectionLimits(np.array([np.inf, np.inf]), SPEED, TICK)
    for _ in range(RAMP):
        limits.tick(TICK, True, np.ones(2))
    np.testing.assert_array_equal(limits(np.array([np.inf, 7.0])), [0.0, 7.0])


def test_signals_of_any_layout_compile_nothing_in_a_control_loop():
    robot = load_robot("double_pendulum")
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 0.1), rate=100.0)

    def run(signal):
        for k in range(60):
            q, v, tau = (signal(np.array(x)) for x in ([0.01 * k, 0.0], [1.0, 0.0], [5.0, 5.0]))
            monitor.update(0.01 * k, q, v, tau)
            monitor.correct(tau, v)

    run(lambda x: x)
    before = len(correction_kernel.bounded.signatures), len(sample_kernel.judge.signatures)
    run(lambda x: np.repeat(x, 2)[::2])
    run(lambda x: np.frombuffer(x.tobytes()))
    assert before == (len(correction_kernel.bounded.signatures), len(sample_kernel.judge.signatures))
