"""The page of probes counts what pytest tries, and names tests that exist."""

import re
from collections import Counter

import pytest

from benchmarks.outcomes import CHECKOUT
from benchmarks.reliability.__main__ import rows
from benchmarks.reliability.counting import Tries
from benchmarks.reliability.probes import KINDS, Kind
from tests.fuzzing.readers import READERS

TESTS = """
import pytest
from hypothesis import assume, given, settings, strategies as st

@pytest.mark.parametrize("x", [1, 2, 3])
def test_cases(x):
    assert x != 2

@given(st.integers())
@settings(max_examples=20, database=None)
def test_inputs(x):
    assume(x != 7)

@given(st.integers(0, 1000))
@settings(max_examples=20, database=None, derandomize=True)
def test_broken(x):
    assert x < 0

@pytest.mark.skip
def test_skipped():
    pass
"""


@pytest.fixture(scope="module")
def tries(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tests")
    (folder / "test_some.py").write_text(TESTS)
    counted = Tries()
    options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--rootdir", str(folder)]
    pytest.main([str(folder / "test_some.py"), *options], plugins=[counted])
    return counted


def test_cases_and_inputs_are_counted_up_to_the_first_that_fails(tries):
    assert tries.tried == Counter(
        {
            "test_some.py::test_cases[1]": 1,
            "test_some.py::test_cases[2]": 1,
            "test_some.py::test_cases[3]": 1,
            "test_some.py::test_inputs": 20,
            "test_some.py::test_broken": 1,
        }
    )
    assert tries.failed == {"test_some.py::test_cases[2]", "test_some.py::test_broken"}


def test_what_did_not_hold_is_lost_where_something_is_at_stake(tries):
    kinds = (
        Kind("cases", "", ("test_some.py::test_cases",), "a file"),
        Kind("one case", "", ("test_some.py::test_cases[2]",)),
        Kind("inputs", "", ("test_some.py::test_inputs", "test_some.py::test_broken")),
    )
    numbers = [row[2:] for row in rows(kinds, tries)]
    assert numbers == [("3", "2", "1 (a file)"), ("1", "0", "–"), ("21", "20", "–"), ("25", "22", 1)]


@pytest.mark.parametrize("test", sorted({test for kind in KINDS for test in kind.tests}))
def test_the_tests_of_a_kind_exist(test):
    file, _, name = test.partition("::")
    text = (CHECKOUT / file).read_text(encoding="utf-8")
    assert re.search(rf"^def {name.partition('[')[0] or 'test_'}", text, re.MULTILINE)


def test_every_kind_of_damaged_file_is_tried():
    cases = {test for kind in KINDS for test in kind.tests if "is_damaged" in test}
    assert {case.partition("[")[2].rstrip("]") for case in cases} == set(READERS)
