"""Logs with gaps: each part between them is looked at by itself, and nothing of what lies in them is made up."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.errors import LogError
from cdia_pin.identification import identify
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.derivatives import uniform
from cdia_pin.logs.recorded_parts import between_gaps, recorded_parts
from tests.made_logs import make

CUTOFF = Conditioning(cutoff=8.0)  # [Hz]
LEVEL = 2.0  # [N·m], Coulomb friction of every joint
PIECES = ((0.0, 6.0), (7.0, 13.0), (15.0, 20.0))  # [s] that were recorded
SIGNALS = ("time", "q", "v", "a", "effort")


@pytest.fixture(scope="module")
def arm():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def whole(arm):
    return make(arm, lambda q, v, a: -LEVEL * np.tanh(v / 1e-3), noise=0.02).log


def piece(log: Log, start: float, stop: float) -> Log:
    first, last = np.searchsorted(log.time, [start, stop])
    return log.slice(int(first), int(last))


def joined(parts: list[Log]) -> Log:
    return replace(
        parts[0],
        **{s: np.concatenate([getattr(p, s) for p in parts]) for s in ("time", "position", "effort")},
    )


@pytest.fixture(scope="module")
def gapped(whole):
    return joined([piece(whole, *ends) for ends in PIECES])


def test_a_log_is_divided_at_its_gaps(whole, gapped):
    assert [(p.start, p.stop) for p in recorded_parts(whole)] == [(0, 2000)]
    assert [p.stop - p.start for p in recorded_parts(gapped)] == [600, 600, 500]


def test_parts_are_logs_of_their_own_unless_all_are_short(gapped):
    assert [len(log.time) for log in between_gaps(gapped, 1.0)] == [600, 600, 500]
    assert [len(log.time) for log in between_gaps(gapped, 5.5)] == [600, 600]
    assert between_gaps(gapped, 60.0) == [gapped]


def test_each_part_is_conditioned_as_if_it_were_alone(arm, whole, gapped):
    found = condition(gapped, arm, CUTOFF)
    alone = [condition(piece(whole, *ends), arm, CUTOFF) for ends in PIECES]
    assert list(found.stretches) == [len(m.time) for m in alone]
    for signal in SIGNALS:
        expected = np.concatenate([getattr(m, signal) for m in alone])
        np.testing.assert_allclose(getattr(found, signal), expected, rtol=1e-6, atol=1e-6)


def test_nothing_in_a_gap_is_compared(arm, gapped):
    time = condition(gapped, arm, CUTOFF).sampled(condition(gapped, arm, CUTOFF).time)
    assert all(any(start < t < stop for start, stop in PIECES) for t in time)


def test_a_part_that_is_too_short_is_left_out_and_it_is_said(arm, whole):
    short = joined([piece(whole, *ends) for ends in (*PIECES[:2], (15.0, 15.3))])
    motion = condition(short, arm, CUTOFF)
    assert motion.time.max() < 13.0
    assert any("2 of its 3 parts" in note and "2 long gaps" in note for note in motion.record["notes"])
    one = condition(joined([piece(whole, 0.0, 9.0), piece(whole, 12.0, 12.3)]), arm, CUTOFF)
    np.testing.assert_allclose(one.q, condition(piece(whole, 0.0, 9.0), arm, CUTOFF).q, atol=1e-6)


def test_a_log_of_short_parts_only_is_refused(arm, whole):
    bits = joined([piece(whole, start, start + 0.4) for start in np.arange(0.0, 20.0, 1.0)])
    with pytest.raises(LogError, match="record it without gaps"):
        condition(bits, arm, CUTOFF)


def test_stretches_of_a_long_log_keep_to_its_parts(arm, gapped):
    spread = condition(gapped, arm, replace(CUTOFF, most=300))
    assert len(spread.stretches) > len(PIECES)
    uniform_in_parts = np.split(spread.time, np.cumsum(spread.stretches)[:-1])
    assert all(np.ptp(np.diff(part)) < 1e-9 for part in uniform_in_parts)
    assert all(any(start <= t < stop for start, stop in PIECES) for t in spread.time)


def test_friction_is_that_of_the_log_without_gaps(arm, whole, gapped):
    """Interpolated, the arm seems to move in its gaps as it never did: levels of 0 to 2.8 N·m are found."""
    for log in (whole, gapped):
        model = identify(Dynamics(arm), log).model
        # a Stribeck curve that does not fall is Coulomb friction
        dry = ("coulomb_friction", "stribeck_friction")
        levels = [t.theta[0] for t in model.terms if t.effect.name in dry]
        assert levels == pytest.approx([LEVEL] * arm.n, rel=0.02)


def test_a_grid_through_gaps_has_no_note_of_its_own(gapped):
    assert not any("gap" in note for note in uniform(gapped).notes)
