"""What was asked of the first use is held by tests that exist, and each row says what became of them."""

from pathlib import Path

import pytest

from benchmarks.first_use.__main__ import row
from benchmarks.first_use.asked import PROMISES, Promise
from benchmarks.first_use.tests_run import TestRun, of_promise

ROOT = Path(__file__).resolve().parents[2]
NAMED = sorted({test for promise in PROMISES for test in promise.tests})


@pytest.mark.parametrize("named", NAMED)
def test_a_named_test_exists(named):
    file, _, name = named.partition("::")
    assert f"def {name or 'test_'}" in (ROOT / file).read_text(encoding="utf-8")


def test_a_skipped_test_holds_nothing():
    promise = Promise("", "", ("a.py", "b.py::test_one"))
    runs = [TestRun("a.py::test_x", "passed", {}), TestRun("b.py::test_one", "skipped", {})]
    others = [TestRun("b.py::test_two", "failed", {}), TestRun("c.py::test_x", "failed", {})]
    assert of_promise([*runs, *others], promise.tests) == runs
    assert row(promise, runs)[-1] == "**no**"
    assert row(promise, runs[:1])[-1] == "yes"
    assert row(promise, [])[-1] == "**no**"


@pytest.mark.parametrize(("figure", "met"), [(0.001, "yes"), (0.02, "**no**")])
def test_the_largest_figure_decides(figure, met):
    promise = Promise("", "", ("a.py",), "difference", 0.01)
    runs = [TestRun("a.py::test_x", "passed", {"difference": x}) for x in (0.0, figure)]
    assert row(promise, runs)[-1] == met
