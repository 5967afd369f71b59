"""Where a fault is present is learned from where it was seen and where not, and only if that is clear."""

import numpy as np
import pytest

from cdia_pin.diagnosis.region import KEPT_SIGHTINGS, RegionLearner, best_cut
from cdia_pin.effects import Region


def learned(present, q, v) -> Region | None:
    learner = RegionLearner("elbow_joint")
    for share, at, speed in zip(np.where(present, 1.0, 0.0), q, v, strict=True):
        learner.add(float(share), float(at), float(speed))
    return learner.region


@pytest.fixture
def signals() -> tuple[np.ndarray, np.ndarray]:
    return tuple(np.random.default_rng(0).uniform(-1, 1, (2, 400)))


def test_a_fault_of_fast_motion_is_found_to_be_one(signals) -> None:
    q, v = signals
    region = learned(np.abs(v) > 0.5, q, v)
    assert region is not None
    assert (region.joint, region.signal, region.upper) == ("elbow_joint", "speed", np.inf)
    assert region.lower == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    ("signal", "side"),
    [("position", "upper"), ("position", "lower"), ("velocity", "lower"), ("speed", "upper")],
)
def test_each_signal_and_side_can_be_found(signals, signal: str, side: str) -> None:
    q, v = signals
    x = {"position": q, "velocity": v, "speed": np.abs(v)}[signal]
    region = learned(x > 0.3 if side == "lower" else x < 0.3, q, v)
    assert region is not None
    assert region.signal == signal
    assert getattr(region, side) == pytest.approx(0.3, abs=0.02)


def test_a_fault_that_comes_and_goes_by_itself_has_no_region(signals) -> None:
    q, v = signals
    assert learned(np.random.default_rng(1).random(400) > 0.5, q, v) is None


def test_a_region_must_get_nearly_all_sightings_right(signals) -> None:
    q, v = signals
    wrong = np.random.default_rng(1).random(400) < 0.12
    assert learned((np.abs(v) > 0.5) ^ wrong, q, v) is None


def test_a_fault_that_is_always_there_has_no_region(signals) -> None:
    q, v = signals
    assert learned(np.ones(400), q, v) is None


def test_half_a_torque_shows_neither_presence_nor_absence() -> None:
    learner = RegionLearner("elbow_joint")
    for k in range(100):
        learner.add(0.45, 0.01 * k, 0.0)
    for k in range(30):
        learner.add(1.0, 0.0, 0.01 * k)
    assert learner.region is None


def test_the_best_cut_is_balanced_between_many_and_few() -> None:
    x = np.r_[np.linspace(0, 1, 1000), np.linspace(1.1, 2, 10)]
    cut, above, right = best_cut(x, x > 1.05)
    assert above
    assert right == pytest.approx(1.0)
    assert 1.0 <= cut <= 1.1


def test_old_sightings_are_dropped_and_no_longer_counted() -> None:
    learner = RegionLearner("elbow_joint")
    for k in range(KEPT_SIGHTINGS):
        learner.add(float(k % 2), 0.5 if k % 2 else -0.5, 0.0)
    assert learner.region is not None
    for _ in range(KEPT_SIGHTINGS):
        learner.add(1.0, 0.5, 0.0)
    assert learner.region is None
