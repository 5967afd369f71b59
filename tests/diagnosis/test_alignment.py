"""State and torque speak of the same instant, exactly where the motion is a parabola and the torque a line."""

import numpy as np
import pytest

from cdia_pin.diagnosis.alignment import Alignment, half_window, slope_of

DT = 1e-3
A, B, C = np.array([0.3, -1.0]), np.array([2.0, 0.1]), np.array([-5.0, 0.7])


def motion(t):
    t = np.asarray(t, float)[..., None]
    return A + B * t + C * t**2, B + 2 * C * t


def effort(t):
    return np.array([10.0, -3.0]) * np.asarray(t, float)[..., None] + 1.0


@pytest.mark.parametrize("position_only", [False, True])
@pytest.mark.parametrize("delay", [0.0, 0.004, 0.0035, -0.002, 0.0125])
def test_state_and_torque_are_of_one_instant(position_only: bool, delay: float) -> None:
    align = Alignment(DT, delay, position_only)
    answered = 0
    for k in range(60):
        now = k * DT
        q, v = motion(now)
        out = align(now, q, None if position_only else v, effort(now))
        if out is None:
            continue
        answered += 1
        then, at, speed, torque = out
        expected = motion(then)
        np.testing.assert_allclose(at, expected[0], rtol=1e-12)
        np.testing.assert_allclose(speed, expected[1], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(torque, effort(then - delay), rtol=1e-9)
        assert now - then == pytest.approx(align.lag * DT, abs=1e-12)
    assert answered > 30


def test_with_velocities_and_no_delay_nothing_waits() -> None:
    align, q = Alignment(DT), np.ones(2)
    t, at, v, tau = align(0.0, q, 2 * q, 3 * q)
    assert (t, align.lag) == (0.0, 0)
    np.testing.assert_array_equal([at, v, tau], [q, 2 * q, 3 * q])


def test_positions_alone_wait_for_half_a_window() -> None:
    assert Alignment(DT, 0.0, True).lag == half_window(DT) == 8
    assert half_window(0.02) == 2  # a slow robot still gets a parabola


def test_a_reset_forgets_the_samples() -> None:
    align = Alignment(DT, 0.0, True)
    zero = np.zeros(2)
    answers = [align(k * DT, zero, None, zero) is not None for k in range(20)]
    align.reset()
    assert answers[-1]
    assert [align(k * DT, zero, None, zero) is not None for k in range(20)] == answers


def test_a_whole_run_is_differentiated_as_the_stream_is() -> None:
    t = np.arange(50) * DT
    q, v = motion(t)
    at, speed = slope_of(q, DT)
    half = half_window(DT)
    np.testing.assert_array_equal(at, q[half:-half])
    np.testing.assert_allclose(speed, v[half:-half], rtol=1e-9)
