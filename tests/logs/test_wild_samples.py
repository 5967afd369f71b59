"""Single samples that no motion makes are named and left out; nothing that an arm did is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from cdia_pin.errors import LogError
from cdia_pin.logs import Log, Severity, check_log
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.wild_samples import repaired, wild_samples, without_wild_samples


def with_value(log: Log, signal: str, row: int | slice, joint: int, value: float) -> Log:
    changed = getattr(log, signal).copy()
    changed[row, joint] = value
    return replace(log, **{signal: changed})


def moving(rate: float, seed: int, noise: float, duration: float = 8.0) -> Log:
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration * rate)) / rate
    angle = 2 * np.pi * np.outer(t, rng.uniform(0.1, 1.0, 2)) + rng.uniform(0, 6, 2)
    q = np.sin(angle) - 1.5 + noise * rng.normal(size=angle.shape)
    effort = 10 * np.cos(angle) + rng.normal(size=angle.shape)
    return Log(("a", "b"), t, q, effort)


@pytest.mark.parametrize("row", [0, 1, 2500, 4998, 4999])
@pytest.mark.parametrize("value", [100.0, -7.0, 0.0, 1e300, -1e308])
def test_one_encoder_value_that_no_motion_makes_is_found_and_left_out(ur5_log, row, value):
    joint = int(np.argmax(np.abs(ur5_log.position[row])))  # there a 0 is wild
    found = wild_samples(with_value(ur5_log, "position", row, joint, value))
    assert [(s.signal, s.joint, s.row) for s in found] == [("position", ur5_log.joints[joint], row)]


def test_a_wild_sample_changes_the_conditioned_motion_no_more_than_its_absence(ur5, ur5_log):
    wild = with_value(ur5_log, "position", 2500, 2, 100.0)
    clean, left_out = condition(ur5_log, ur5), condition(wild, ur5)
    assert left_out.cutoff == clean.cutoff
    np.testing.assert_allclose(left_out.a, clean.a, atol=0.05)
    assert "1 sample" in left_out.record["notes"][-1] and "100" in left_out.record["notes"][-1]


def test_the_check_names_the_sample_and_judges_the_rest_without_it(ur5, ur5_log):
    found = check_log(with_value(ur5_log, "position", 2500, 2, 100.0), ur5)
    (wild,) = found.about("wild")
    assert wild.severity is Severity.WARNING and "100" in wild.message and "t = 10" in wild.message
    assert wild.joint == "elbow_joint"
    expected = [
        f.message for f in check_log(ur5_log, ur5).findings if f.topic in {"sign", "limits", "joint_order"}
    ]
    assert [f.message for f in found.findings if f.topic in {"sign", "limits", "joint_order"}] == expected


def test_an_effort_of_zero_or_beyond_all_others_is_wild(ur5_log):
    row = int(np.argmin(np.abs(ur5_log.effort[:, 1] - np.percentile(ur5_log.effort[:, 1], 5))))
    for value in (0.0, 1e6, -1e6):
        (found,) = wild_samples(with_value(ur5_log, "effort", row, 1, value))
        assert (found.signal, found.row) == ("effort", row)


def test_a_velocity_that_comes_and_goes_faster_than_any_is_wild_where_velocities_are_used(ur5, ur5_log):
    velocity = np.gradient(ur5_log.position, ur5_log.time, axis=0)
    recorded = replace(ur5_log, velocity=velocity)
    assert wild_samples(recorded, velocities=True) == ()
    for row in (0, 2500, 4999):
        bad = with_value(recorded, "velocity", row, 1, -300.0)
        (found,) = wild_samples(bad, velocities=True)
        assert (found.signal, found.row, found.value) == ("velocity", row, -300.0)
        assert wild_samples(bad) == ()
        mended = without_wild_samples(bad, velocities=True)
        np.testing.assert_allclose(mended.velocity, velocity, atol=0.05)
        (said,) = check_log(bad, ur5).about("wild")
        assert said.severity is Severity.WARNING and "the velocity has 1 value" in said.message


def test_a_log_with_too_many_is_refused_with_their_share(ur5, ur5_log):
    position = ur5_log.position.copy()
    position[np.random.default_rng(0).choice(5000, 600, replace=False), 1] = 50.0
    bad = replace(ur5_log, position=position)
    with pytest.raises(LogError, match=r"1\d % of the samples"):
        condition(bad, ur5)
    (found,) = check_log(bad, ur5).about("wild")
    assert found.severity is Severity.ERROR


def test_a_log_without_them_is_returned_as_it_is(ur5_log, panda_log):
    for log in (ur5_log, panda_log):
        assert without_wild_samples(log) is log


@given(
    rate=st.sampled_from([50.0, 100.0, 250.0, 500.0, 1000.0]),
    seed=st.integers(0, 2**32 - 1),
    noise=st.sampled_from([0.0, 1e-5, 1e-3]),
    rows=st.sets(st.integers(3, 396), max_size=3),
    value=st.one_of(st.floats(2.0, 1e308), st.floats(-1e308, -5.0)),
)
@settings(max_examples=150, deadline=None)
@example(rate=50.0, seed=0, noise=0.0, rows={3, 4, 5}, value=100.0)
def test_exactly_the_values_that_were_broken_are_found(rate, seed, noise, rows, value):
    log = moving(rate, seed, noise)
    apart = {k for k in rows if not {k - 1, k + 1, k - 2, k + 2} & rows}
    broken = with_value(log, "position", sorted(rows), 0, value) if rows else log
    found = {s.row for s in wild_samples(broken)}
    assert apart <= found <= {k + d for k in rows for d in (-1, 0, 1)}
    mended = repaired(broken, wild_samples(broken))
    assert np.abs(mended.position - log.position).max() < 0.5


@given(seed=st.integers(0, 2**32 - 1), hold=st.integers(1, 100), step=st.sampled_from([0.0, 1e-4, 0.01]))
@settings(max_examples=60, deadline=None)
def test_nothing_that_a_joint_did_is_wild(seed, hold, step):
    # noise, values that are held for up to 0.1 s, a coarse encoder
    log = moving(1000.0, seed, 1e-4)
    position = log.position[np.arange(len(log.time)) // hold * hold]
    position = np.round(position / step) * step if step else position
    assert wild_samples(replace(log, position=position)) == ()


@pytest.mark.parametrize("value", [0.0, 100.0, -7.0, 1e300])
@pytest.mark.parametrize("seconds", [0.02, 0.1, 0.3, 0.45])
def test_a_wrong_position_that_is_held_is_found_and_left_out(ur5, ur5_log, value, seconds):
    joint = int(np.argmax(np.abs(ur5_log.position[2500])))
    rows = slice(2500, 2500 + round(seconds * ur5_log.rate))
    broken = with_value(ur5_log, "position", rows, joint, value)
    found = wild_samples(broken)
    assert [s.row for s in found] == list(range(rows.start, rows.stop))
    left_out = condition(broken, ur5)
    missing = ~np.isin(np.arange(len(ur5_log.time)), range(rows.start, rows.stop))
    gap = replace(
        ur5_log, **{s: getattr(ur5_log, s)[missing] for s in ("time", "position", "velocity", "effort")}
    )
    np.testing.assert_allclose(left_out.q[:, joint], condition(gap, ur5).q[:, joint], atol=1e-6)
    assert f"{ur5_log.joints[joint]} " in left_out.record["notes"][-1]


def test_the_check_says_from_when_on_a_wrong_position_was_held(ur5, ur5_log):
    (said,) = check_log(with_value(ur5_log, "position", slice(2500, 2600), 2, 0.0), ur5).about("wild")
    assert said.severity is Severity.WARNING
    assert "has 100 values that no motion makes: 0 from t = 10 s on; the other" in said.message


def test_a_position_that_is_wrong_for_longer_or_comes_back_slowly_is_not_called_wild(ur5_log):
    assert wild_samples(with_value(ur5_log, "position", slice(2500, 2650), 2, 100.0)) == ()
    slowly = ur5_log.position.copy()
    slowly[2500:2600, 2] = 2.0 + slowly[2500, 2]
    slowly[2600:2700, 2] += np.linspace(2.0, 0.0, 100)
    assert wild_samples(replace(ur5_log, position=slowly)) == ()


def test_a_wrong_position_is_found_while_the_joint_rests_and_rest_is_not_wild():
    log = moving(250.0, 0, 0.0)
    position = log.position[np.clip(np.arange(len(log.time)), 0, 300)]
    assert wild_samples(replace(log, position=position)) == ()
    position[700:750, 0] += 0.3
    assert {s.row for s in wild_samples(replace(log, position=position))} == set(range(700, 750))


def test_a_log_whose_positions_are_held_wrong_for_a_tenth_of_it_is_refused(ur5, ur5_log):
    position = ur5_log.position.copy()
    position[:, 2] += np.where(np.arange(5000) // 100 % 8 == 7, 2.0, 0.0)  # six of 0.4 s, a value each
    for start in range(700, 5000, 800):
        position[start : start + 100, 2] = position[start, 2]
    bad = replace(ur5_log, position=position)
    assert len(wild_samples(bad)) == 600
    with pytest.raises(LogError, match="12 % of the samples"):
        condition(bad, ur5)
    (found,) = check_log(bad, ur5).about("wild")
    assert found.severity is Severity.ERROR


def test_measured_logs_hold_none(measured_logs):
    for log, _ in measured_logs:
        assert wild_samples(log, velocities=True) == (), log.source


def test_measured_logs_that_are_updated_slowly_hold_none(measured_logs):
    for log, _ in measured_logs:
        for hold in (5, 20):
            position = log.position[np.arange(len(log.time)) // hold * hold]
            assert wild_samples(replace(log, position=position)) == (), log.source


@pytest.mark.parametrize("every", [200, 40, 10])
def test_absurd_efforts_do_not_hide_each_other(ur5, ur5_log, every):
    """Half a percent of them makes the range of the efforts as large as themselves."""
    joint, rows = 2, np.arange(len(ur5_log.time) // 2, len(ur5_log.time), every)
    broken = with_value(ur5_log, "effort", rows, joint, 1e6)
    found = wild_samples(broken)
    assert [s.row for s in found] == rows.tolist()
    assert {(s.signal, s.joint) for s in found} == {("effort", ur5.joints[joint])}


@pytest.mark.parametrize("gap", [0.0, 0.7])
def test_a_row_that_a_failed_bus_left_is_wild_in_all_positions_and_efforts(gap):
    """Before, a joint that is near the row's value and all efforts of 0 stayed; beside a gap the whole row did."""
    log, row = moving(100.0, 3, 1e-4), 700
    position, effort = (np.column_stack([x, x[:, ::-1]]) for x in (log.position, log.effort))
    position[:, 0] -= position[row, 0] + np.pi + 0.01  # what the bus leaves is near where this joint is
    position[row], effort[row] = -np.pi, 0.0
    time = log.time + gap * (np.arange(len(log.time)) >= row)
    found = wild_samples(Log(tuple("abcd"), time, position, effort))
    assert {s.row for s in found} == {row}
    assert [(s.signal, s.joint) for s in found] == [(k, j) for k in ("position", "effort") for j in "abcd"]


def test_rows_that_a_failed_bus_left_are_said_once(ur5, ur5_log):
    position, effort = ur5_log.position.copy(), ur5_log.effort.copy()
    position[[900, 2500]], effort[[900, 2500]] = -np.pi, 0.0
    (said,) = check_log(replace(ur5_log, position=position, effort=effort), ur5).about("wild")
    assert said.joint is None and said.value["rows"] == [900, 2500]
    assert "2 rows in which nothing was measured" in said.message


def test_a_bus_that_fails_for_a_third_of_a_second_is_one_event():
    log = moving(100.0, 3, 1e-4)
    rows, position, effort = slice(400, 430), log.position.copy(), log.effort.copy()
    position[rows], effort[rows] = 3.0, 0.0
    broken = replace(log, position=position, effort=effort)
    found = wild_samples(broken)
    assert {s.row for s in found} == set(range(400, 430))
    assert all(s.held for s in found)
    assert np.abs(without_wild_samples(broken).effort[rows]).max() > 0.0  # not refused
