"""Outcomes on their way to the page: nothing is lost in a file, and what never happened is no number."""

from dataclasses import replace
from math import isnan, nan

import pytest

pytest.importorskip("mujoco")

from benchmarks.online.claims import PARTS, fell_short, middle, share
from benchmarks.online.outcome import JointOutcome, Outcome
from benchmarks.online.page import page
from benchmarks.online.plan import SUITES, Store, fingerprint, planned

JOINT = JointOutcome(
    "b",
    True,
    0.02,
    0.03,
    nan,
    nan,
    "unique",
    ("coulomb_friction",),
    True,
    True,
    True,
    1.1,
    0.1,
    0.95,
    nan,
    "",
)
MISSED = replace(JOINT, detected=False, delay=nan, since_begin=nan, right=False, unique=False, holds=False)
GOOD = Outcome("ur5/single/x", "single", "ur5", "usual", 0.2, ("coulomb_friction@b",), 0.2, 0, 0, (JOINT,))
BAD = replace(GOOD, id="ur5/single/y", joints=(MISSED,), said=("5.00 s detection c",), false_alarms=1)


def test_an_outcome_comes_back_from_its_line_and_nan_is_null() -> None:
    line = BAD.to_json()
    assert "NaN" not in line
    back = Outcome.from_json(line)
    assert back.to_json() == line
    assert isnan(back.joints[0].delay)
    assert replace(back.joints[0], delay=0.0, since_begin=0.0).named == ("coulomb_friction",)


def test_an_interrupted_run_keeps_what_was_whole(tmp_path) -> None:
    store = Store("ur5", "version", tmp_path)
    for outcome in (GOOD, BAD):
        store.add(outcome)
    store.path.write_text(store.path.read_text()[:-30])  # stopped within a line
    assert list(store.read()) == [GOOD.id]
    assert Store("ur5", "other", tmp_path).read() == {}
    store.forget()
    assert store.read() == {}


def test_the_fingerprint_is_the_same_each_time() -> None:
    assert fingerprint() == fingerprint()


def test_cases_of_all_suites_have_names_of_their_own() -> None:
    of = {suite: planned("scara", [suite]) for suite in SUITES}
    assert all(of.values())
    names = [c.id for cases in of.values() for c in cases]
    assert len(set(names)) == len(names)
    assert {c.id for c in planned("scara", quick=True)} < set(names)
    assert sum(c.duration for c in of["hour"]) == 3600.0


def test_figures_count_what_they_say() -> None:
    assert share(lambda j: j.detected)([GOOD, BAD]).text == "50\u00a0% (1/2)"
    assert middle(lambda j: j.delay, " ms", 1e3)([GOOD, BAD]).n == 1
    assert isnan(share(lambda j: j.detected)([]).value)
    assert middle(lambda j: j.learned)([GOOD]).text == "–"


def test_what_fell_short_is_said() -> None:
    assert fell_short(GOOD) == []
    assert fell_short(BAD) == ["false alarm", "not detected"]
    lost = replace(GOOD, suite="return", joints=(JOINT,))
    assert fell_short(lost) == ["not dropped in 1 s", "not found again"]


def test_the_page_says_where_a_target_is_not_met_and_which_cases_fell_short() -> None:
    text = page([GOOD, BAD], None, "python -m benchmarks.online", quick=False)
    assert "| Faults of 20 % and above: detected | ≥ 99 % | 50\u00a0% (1/2) | 2 | **NOT met** |" in text
    assert "`ur5/single/y`" in text
    assert "`ur5/single/x`" not in text


def test_every_case_that_has_a_target_is_in_one_part_with_targets() -> None:
    with_targets = [p for p in PARTS if any(c.target for c in p.claims)]
    assert sum(p.chosen(GOOD) for p in with_targets) == 1
