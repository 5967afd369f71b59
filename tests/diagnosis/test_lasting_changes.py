"""What lasts until the end of a log, below the monitor's threshold too; friction and noise are written out here."""

from dataclasses import replace

import numpy as np
import pytest
from made_logs import make

from cdia_pin.changes import Change, Changes, what_changed
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.overlap import NotCompared
from cdia_pin.diagnosis import (
    Event,
    EventStage,
    Monitor,
    SensorCondition,
    SensorFault,
    SensorSignal,
    Status,
    Verdict,
    lasting_changes,
    replay,
)
from cdia_pin.diagnosis.begin_of_change import begin_of
from cdia_pin.diagnosis.lasting_changes import Disturbances, LastingChanges
from cdia_pin.diagnosis.status import NO_CONTACT
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ExternalWrench, Term, parse_term
from cdia_pin.errors import LogError
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.rest import RestSettings
from cdia_pin.robot import load_robot
from cdia_pin.viewers import run_summary

ARM = load_robot("ur5")
JOINT = "elbow_joint"
ELBOW = ARM.joint_index(JOINT)
NOISE = 0.5  # [N·m]
QUIET = Status(9.0, (), *np.zeros((3, ARM.n)))
TOUCHED = replace(QUIET, faults=(Term(ExternalWrench(ARM.joints[-1]), (0.0,) * 6),))
WRONG = 2.0  # [N·m], by which the model of the elbow is wrong at each posture, so that its threshold is wide


def run(seed: int, friction: float = 0.0, begin: float = 0.0, duration: float = 30.0) -> Log:
    """A run in which viscous friction [N·m·s/rad] of the elbow begins at a time [s]."""
    made = make(
        ARM,
        lambda q, v, a: WRONG * np.sin(3.0 * q) * np.eye(ARM.n)[ELBOW],
        seed=seed,
        duration=duration,
        noise=NOISE,
    )
    worn = friction * made.v[:, ELBOW] * (made.log.time >= begin)
    effort = made.log.effort + np.outer(worn, np.eye(ARM.n)[ELBOW])
    return replace(made.log, effort=effort, source=f"run {seed}")


@pytest.fixture(scope="module")
def healthy() -> Log:
    return run(1)


def test_a_fault_below_the_threshold_is_established(healthy: Log) -> None:
    monitor = Monitor(Dynamics(ARM), healthy=[healthy])
    found = replay(monitor, run(2, friction=1.0), compare_with=[healthy])
    assert not [e for e in found.events if e.stage is EventStage.DETECTION]
    assert found.lasting is not None
    (change,) = found.lasting.established
    assert change.term.label == f"viscous_friction@{JOINT}"
    assert abs(change.term.theta[0] - 1.0) < 0.1
    assert "Established since the healthy runs (0 to 29.99 s): viscous friction on elbow" in run_summary(
        found
    )
    assert found.to_dict()["lasting"]["changes"]["verdict"] == "changed"
    same, other = (
        parse_term(f"{kind}_friction@{JOINT}: {size}=1")
        for kind, size in (("viscous", "coefficient"), ("coulomb", "level"))
    )
    assert "surer" not in run_summary(replace(found, faults=(same,)))
    assert "This name is surer than that at the end" in run_summary(replace(found, faults=(other,)))


def test_an_unchanged_arm_is_said_to_be_unchanged(healthy: Log) -> None:
    found = replay(Monitor(Dynamics(ARM), healthy=[healthy]), run(3), compare_with=[healthy])
    assert found.lasting is not None
    assert not found.lasting.established
    assert "No change since the healthy runs is established" in run_summary(found)


def test_a_fault_that_began_late_is_found_in_a_window_of_its_own(healthy: Log) -> None:
    late = lasting_changes(Dynamics(ARM), [healthy], run(2, friction=1.0, begin=45.0, duration=60.0))
    assert late.begin >= 30.0 - 1.0
    assert [c.term.label for c in late.established] == [f"viscous_friction@{JOINT}"]


def test_a_window_begins_where_its_change_does(healthy: Log) -> None:
    found = lasting_changes(Dynamics(ARM), [healthy], run(2, friction=1.0, begin=10.0))
    assert found.begin == pytest.approx(10.0, abs=1.0)  # half of the log begins at 15 s
    (change,) = found.established
    low, high = change.term.ci95[0]
    assert low < 1.0 < high


def test_a_longer_window_tells_what_changed_and_its_part_how_much() -> None:
    def window(size: float, confidence: Confidence) -> LastingChanges:
        found = slight(f"viscous_friction@{JOINT}: coefficient={size}")
        (change,) = found.changes
        sized = replace(change, term=change.term.with_intervals(np.array([0.1])), confidence=confidence)
        return LastingChanges(0.0, 9.0, replace(found, changes=(sized,)))

    part = window(1.0, Confidence.LIKELY)
    (change,) = part.confirmed_by(window(0.4, Confidence.ESTABLISHED)).established
    assert change.term.theta == (1.0,)
    assert not part.confirmed_by(window(0.4, Confidence.LIKELY)).established


def slight(term: str, not_compared: dict[str, NotCompared] | None = None) -> Changes:
    """A change, as a window that begins before it gives it: too small."""
    change = Change(parse_term(term), None, np.zeros(ARM.n), 1.0)
    nothing = what_changed(Dynamics(ARM), run(1, duration=8.0), run(3, duration=8.0))
    return replace(nothing, changes=(change,), not_compared=not_compared or {})


@pytest.mark.parametrize("begin", [0.0, 10.0, 20.0])
def test_the_begin_of_a_change_is_found_though_its_size_is_too_small(healthy: Log, begin: float) -> None:
    found = begin_of(
        [condition(healthy, ARM)],
        condition(run(2, friction=1.0, begin=begin), ARM),
        slight(f"viscous_friction@{JOINT}: coefficient=0.4"),
        RestSettings(),
    )
    # where the model is wrong by as much, it may seem to begin earlier
    assert begin - 4.0 <= found <= begin + 0.5


@pytest.mark.parametrize("begin", [0.0, 10.0, 20.0])
@pytest.mark.parametrize("seed", [2, 3, 5])
def test_friction_that_the_model_lacks_all_the_time_does_not_hide_the_begin(begin: float, seed: int) -> None:
    def rubs(seed: int, offset: float) -> Log:
        one = np.eye(ARM.n)[ELBOW]
        made = make(
            ARM, lambda q, v, a: -10.0 * np.tanh(v / 0.01) * one, seed=seed, duration=30.0, noise=NOISE
        )
        late = offset * (made.log.time >= begin)
        return replace(made.log, effort=made.log.effort - np.outer(late, one), source=f"run {seed}")

    window = condition(rubs(seed, 2.0), ARM)
    changes = slight(f"torque_offset@{JOINT}: offset=2.0")
    found = begin_of([condition(rubs(1, 0.0), ARM)], window, changes, RestSettings())
    assert found == pytest.approx(begin, abs=0.5)


def test_a_joint_that_is_not_compared_says_nothing_of_the_begin(healthy: Log) -> None:
    before, window = [condition(healthy, ARM)], condition(run(2, friction=1.0, begin=10.0), ARM)
    changes = slight(f"viscous_friction@{JOINT}: coefficient=0.4", {JOINT: NotCompared.RESTS_BEFORE})
    assert begin_of(before, window, changes, RestSettings()) == window.time[0]


def test_a_zero_begins_with_the_window(healthy: Log) -> None:
    window = condition(run(2), ARM)
    changes = slight(f"encoder_offset@{JOINT}: offset=0.1")
    assert begin_of([condition(healthy, ARM)], window, changes, RestSettings()) == window.time[0]


def test_what_is_likely_is_said_where_a_fault_is_believed(healthy: Log) -> None:
    found = replay(Monitor(Dynamics(ARM), healthy=[healthy]), run(2, friction=1.0), compare_with=[healthy])
    assert found.lasting is not None
    (change,) = found.lasting.established
    likely = replace(found.lasting.changes, changes=(replace(change, confidence=Confidence.LIKELY),))
    doubtful = replace(found, lasting=replace(found.lasting, changes=likely))
    assert "No change since the healthy runs is established" in run_summary(doubtful)
    assert "Likely changed since the healthy runs" in run_summary(replace(doubtful, faults=(change.term,)))


def test_what_was_pushed_is_not_compared(healthy: Log) -> None:
    watched = run(2, friction=1.0)
    pushed = (watched.time > 4.0) & (watched.time < 10.0)
    part = lasting_changes(Dynamics(ARM), [healthy], watched, disturbed=pushed)
    assert part.begin >= 10.0
    assert part.end == watched.time[-1]


def test_a_bad_sensor_at_the_end_leaves_what_was_before_it(healthy: Log) -> None:
    watched = run(2, friction=1.0)
    before = lasting_changes(Dynamics(ARM), [healthy], watched, disturbed=watched.time > 27.0)
    assert before.end == pytest.approx(27.0, abs=0.02)
    assert [c.term.label for c in before.established] == [f"viscous_friction@{JOINT}"]


def test_nothing_is_compared_where_everything_is_disturbed(healthy: Log) -> None:
    watched = run(2, friction=1.0)
    often = np.arange(len(watched.time)) % 200 == 0
    with pytest.raises(LogError, match=r"no \d.* s without contact and with good sensors"):
        lasting_changes(Dynamics(ARM), [healthy], watched, disturbed=often)


def test_nothing_is_compared_unless_asked(healthy: Log) -> None:
    found = replay(Monitor(Dynamics(ARM), healthy=[healthy]), run(3, duration=6.0))
    assert found.lasting is None
    assert "lasting" not in found.to_dict()


def test_runs_that_cannot_be_compared_stop_nothing(healthy: Log) -> None:
    resting = replace(healthy, position=np.zeros_like(healthy.position), source="rests")
    assert not lasting_changes(Dynamics(ARM), [healthy], resting).established


def test_an_end_that_is_too_short_to_compare_is_said(healthy: Log) -> None:
    short = run(3, duration=2.5)
    found = replay(Monitor(Dynamics(ARM), healthy=[healthy]), short, compare_with=[healthy])
    assert found.lasting is None
    assert found.to_dict()["not_compared"] == found.not_compared
    assert "The end of the log was not compared with the healthy runs:" in run_summary(found)


def test_contacts_and_bad_sensors_disturb() -> None:
    broken = SensorFault(JOINT, SensorSignal.POSITION, SensorCondition.FROZEN, since=8.0)
    seen = Disturbances()
    for status in (QUIET, TOUCHED, replace(QUIET, sensors=(broken,)), QUIET):
        seen.see(status)
    assert seen.mask.tolist() == [False, True, True, False]


def test_what_turned_out_to_be_no_contact_disturbs_nothing() -> None:
    """A payload that was called a contact at first cut the log in two, and the shorter part gave a wrong mass."""
    ended = Event(9.0, EventStage.IDLE, ARM.joints, Verdict.NONE, reason=NO_CONTACT)
    seen = Disturbances()
    for status in (TOUCHED, QUIET, TOUCHED, TOUCHED, replace(QUIET, events=(ended,))):
        seen.see(status)
    assert seen.mask.tolist() == [True, False, False, False, False]
