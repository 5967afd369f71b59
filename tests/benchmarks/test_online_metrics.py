"""Measures of a monitor, on small made-up runs where the answer is plain."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from benchmarks.online import EXACT, NominalControl, OnlinePlant, OnlineRun, baseline
from benchmarks.online import metrics as m
from benchmarks.plant import Fault
from benchmarks.plant.motion import Reference


@dataclass(frozen=True)
class Said:
    label: str


@dataclass(frozen=True)
class Event:
    time: float
    stage: str
    joints: tuple[str, ...] = ("b",)
    verdict: str = "unique"
    faults: tuple[Said, ...] = ()
    alternatives: tuple[tuple[Said, ...], ...] = ()


COULOMB, VISCOUS, SPRING = Said("coulomb_friction@b"), Said("viscous_friction@b"), Said("joint_spring@b")


FAULTS = (Fault("coulomb_friction", joint="b", after=3.0),)


def made(f_b: np.ndarray, faults: tuple[Fault, ...] = FAULTS, error=0.0) -> OnlineRun:
    """Ten seconds at 10 Hz of joints a and b; f on b."""
    zeros = np.zeros((100, 2))
    f, q = zeros.copy(), zeros.copy()
    f[:, 1], q[:] = f_b, np.reshape(error, (-1, 1))
    reference = Reference(zeros, zeros, zeros)
    return OnlineRun(
        ("a", "b"), np.arange(100) / 10, q, None, zeros, zeros, q, zeros, zeros, reference, f, faults
    )


@pytest.fixture
def run() -> OnlineRun:
    """A fault from 3 s on that grows by 1 N·m a second."""
    t = np.arange(100) / 10
    return made(np.maximum(t - 3.0, 0.0))


def test_false_alarms_are_those_before_the_fault_and_on_healthy_joints(run: OnlineRun) -> None:
    early, right, elsewhere = (
        Event(2.0, "detection"),
        Event(4.0, "detection"),
        Event(5.0, "detection", ("a",)),
    )
    events = [early, right, elsewhere, Event(1.0, "isolation")]
    assert m.false_alarms(run, events) == [early, elsewhere]


def test_a_joint_whose_fault_vanished_is_not_a_false_alarm() -> None:
    f = np.zeros(100)
    f[30:40] = 1.0
    assert m.false_alarms(made(f), [Event(5.0, "detection")]) == []


def test_delay_counts_from_when_the_faults_torque_exceeds_the_threshold(run: OnlineRun) -> None:
    events = [Event(1.0, "detection"), Event(4.4, "detection"), Event(4.9, "detection")]
    assert m.onset(run, [1.0, 1.0], "b", 3.0) == pytest.approx(4.1)
    assert m.detection_delay(run, events, [1.0, 1.0], "b", 3.0) == pytest.approx(0.3)
    moving = np.ones((100, 2))
    moving[:50] = 9.0  # a threshold that is lower from 5 s on
    assert m.detection_delay(run, events, moving, "b", 3.0) == pytest.approx(-0.6)
    assert np.isnan(m.detection_delay(run, [], [1.0, 1.0], "b"))
    assert np.isnan(m.detection_delay(run, events, [1.0, 99.0], "b"))


def test_isolation_is_what_was_said_last_within_the_time(run: OnlineRun) -> None:
    events = [
        Event(4.0, "detection", verdict="none"),
        Event(4.5, "isolation", faults=(VISCOUS,)),
        Event(5.0, "isolation", faults=(COULOMB,)),
        Event(8.5, "isolation", faults=(VISCOUS,)),
    ]
    found = m.isolation_after_detection(run, events, "b")
    assert (found.right, found.unique, found.holds_truth, found.time) == (True, True, True, 5.0)
    assert not m.isolation_after_detection(run, events, "b", within=0.7).right
    assert not m.isolation_after_detection(run, events, "b", within=5.0).right
    assert m.isolation_after_detection(run, events[:1], "b").verdict == "none"


def test_ambiguous_isolation_may_hold_the_truth(run: OnlineRun) -> None:
    ambiguous = Event(5.0, "isolation", verdict="ambiguous", faults=(VISCOUS,), alternatives=((COULOMB,),))
    found = m.isolation(run, [ambiguous], "b", at=8.0)
    assert (found.right, found.unique, found.holds_truth) == (False, False, True)
    found = m.isolation(run, [replace(ambiguous, faults=(COULOMB,), alternatives=((VISCOUS,),))], "b", at=8.0)
    assert (found.right, found.unique, found.holds_truth) == (True, False, True)


def test_more_than_the_truth_is_wrong_and_unknown_names_nothing(run: OnlineRun) -> None:
    assert not m.isolation(run, [Event(5.0, "isolation", faults=(COULOMB, SPRING))], "b", 8.0).holds_truth
    unknown = m.isolation(run, [Event(5.0, "isolation", verdict="unknown")], "b", 8.0)
    assert (unknown.verdict, unknown.right, unknown.holds_truth) == ("unknown", False, False)


def test_faults_of_other_joints_in_the_same_event_do_not_count(run: OnlineRun) -> None:
    both = Event(5.0, "isolation", ("a", "b"), faults=(COULOMB, Said("torque_offset@a")))
    assert m.isolation(run, [both], "b", 8.0).unique


def test_the_same_torque_by_another_name_is_right() -> None:
    faults = (Fault("torque_offset", joint="b"), Fault("joint_spring", joint="b"))
    run = made(np.ones(100), faults)
    assert m.isolation(run, [Event(5.0, "isolation", faults=(SPRING,))], "b", 8.0).right


def test_tracking_is_that_of_the_last_seconds() -> None:
    error = np.zeros(100)
    error[:50], error[80:] = 9.0, 0.2
    one = made(np.zeros(100), (), error)
    assert m.tracking_rms(one, last=2.0)[1] == pytest.approx(0.2)
    healthy, without = made(np.zeros(100), (), 0.1), made(np.zeros(100), (), 2.0)
    compared = m.tracking(one, healthy, without, last=2.0)
    assert compared.against_healthy[1] == pytest.approx(2.0)
    assert compared.improvement[1] == pytest.approx(10.0)
    assert m.tracking(one, healthy, None).improvement[1] == np.inf  # without, the arm fell


def test_recovered_share_is_one_for_the_truth_and_zero_for_its_mean(run: OnlineRun) -> None:
    f = run.fault_torque
    assert m.recovered_share(run, f, since=3.0)[1] == pytest.approx(1.0)
    assert np.isnan(m.recovered_share(run, f, since=3.0)[0])
    late = run.time >= 3.0
    assert m.recovered_share(run, np.full_like(f, f[late, 1].mean()), 3.0)[1] == pytest.approx(0.0)
    assert m.recovered_share(run, f + 1.0, since=3.0)[1] < 1.0  # a wrong offset counts


def test_drop_and_return() -> None:
    faults = tuple(
        Fault("coulomb_friction", joint="b", **times) for times in ({"until": 5.0}, {"after": 8.0})
    )
    run = made(np.ones(100), faults)
    events = [
        Event(5.3, "idle", verdict="none", faults=(COULOMB,)),
        Event(8.1, "isolation", faults=(VISCOUS,)),
        Event(8.4, "accommodation", faults=(COULOMB,)),
    ]
    assert m.drop_delay(events, "b", 5.0, 8.0) == pytest.approx(0.3)
    assert np.isnan(m.drop_delay(events, "a", 5.0))
    assert np.isnan(m.drop_delay(events[1:], "b", 5.0, 8.0))
    assert m.found_again_delay(run, events, "b", 8.0) == pytest.approx(0.4)
    assert np.isnan(m.found_again_delay(run, events[:2], "b", 8.0))


# ---------------------------------------------------------------- baseline


def test_momentum_observer_tends_to_the_missing_torque_with_its_time_constant() -> None:
    plant = OnlinePlant("ur5", model_error=0.0, sensors=EXACT)
    fault = Fault("torque_offset", joint="elbow_joint", offset=4.0, after=0.5)
    run = plant.run(NominalControl(plant.robot), plant.reference(seed=3), [fault], 1.0)
    r = baseline.residual(plant.robot, run, gain=20.0)
    since = np.maximum(run.time - 0.5, 0.0)
    np.testing.assert_allclose(r[:, 2], 4.0 * (1 - np.exp(-20.0 * since)), atol=0.05)
    assert np.abs(np.delete(r, 2, axis=1)).max() < 0.05  # one joint's fault is seen on that joint alone


def test_baseline_detects_with_a_threshold_from_healthy_runs() -> None:
    plant = OnlinePlant("ur5", seed=1)
    control, reference = NominalControl(plant.robot), plant.reference(seed=3)
    healthy = baseline.residual(plant.robot, plant.run(control, reference, (), 2.0, seed=1))
    limit = baseline.threshold(healthy)
    np.testing.assert_allclose(limit, 1.3 * np.abs(healthy).max(axis=0))
    fault = Fault("coulomb_friction", joint="elbow_joint", level=6.0, after=1.0)
    run = plant.run(control, reference, [fault], 2.0, seed=2)
    found = baseline.detection_times(run.time, baseline.residual(plant.robot, run), limit)
    assert 1.0 < found[2] < 1.2
    assert np.isnan(np.delete(found, 2)).all()


def test_observer_without_velocities_is_refused() -> None:
    plant = OnlinePlant("ur5", sensors=EXACT)
    run = plant.run(NominalControl(plant.robot), plant.reference(), (), 0.1)
    with pytest.raises(ValueError, match="positions only"):
        baseline.residual(plant.robot, replace(run, v_measured=None))
