"""After how many samples a motion repeats."""

import numpy as np
import pytest

from cdia_pin.logs.repeats import period_of

RATE = 20.0  # [Hz]


def sines(frequencies, duration, seed=0):
    """Positions of three joints, each with sines of all frequencies [Hz]."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, duration, 1.0 / RATE)
    phases = 2 * np.pi * np.outer(time, frequencies)
    return np.sin(phases) @ rng.standard_normal((len(frequencies), 3)) + np.cos(phases) @ rng.standard_normal(
        (len(frequencies), 3)
    )


@pytest.mark.parametrize("duration", [8.0, 12.0, 18.0, 25.0])
def test_the_period_of_a_motion_that_is_driven_again(duration):
    assert period_of(sines(np.arange(1, 6) / 6.0, duration)) == pytest.approx(6.0 * RATE, abs=1)


def test_a_controller_repeats_a_motion_only_nearly():
    q = sines(np.arange(1, 6) / 6.0, 18.0)
    q += 0.02 * np.random.default_rng(1).standard_normal(q.shape)
    assert period_of(q) == pytest.approx(6.0 * RATE, abs=1)


def test_the_joints_that_rest_do_not_matter():
    q = sines(np.arange(1, 6) / 6.0, 18.0)
    q[:, 1] = 0.3 + 1e-4 * np.random.default_rng(1).standard_normal(len(q))
    assert period_of(q) == pytest.approx(6.0 * RATE, abs=1)


def test_all_joints_must_be_back():
    q = sines([1 / 3.0], 30.0)
    q[:, 2] = np.sin(2 * np.pi * np.arange(len(q)) / (4.0 * RATE))
    assert period_of(q) == pytest.approx(12.0 * RATE, abs=1)


@pytest.mark.parametrize(
    "q",
    [
        sines([0.13, 0.29, 0.41, 0.53], 20.0),
        sines(np.arange(1, 6) / 6.0, 6.5),  # a little longer than its period
        np.linspace(0.0, 1.0, 200)[:, None],
        np.zeros((100, 2)),
        np.zeros((0, 2)),
        np.zeros((1, 2)),
    ],
    ids=["incommensurate", "driven once", "one stroke", "at rest", "empty", "one sample"],
)
def test_other_motions_have_none(q):
    assert period_of(q) is None
