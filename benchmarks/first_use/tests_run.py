"""Tests of this checkout, run once, and what became of each."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from benchmarks.outcomes import CHECKOUT, environment_of

BAD = ("failure", "error")  # elements of a test that did not pass


@dataclass(frozen=True)
class TestRun:
    """What became of one test.

    Attributes:
        name: ``file::test``, without its parameters.
        state: ``passed``, ``failed`` or ``skipped``.
        figures: What it measured, by name.
    """

    __test__ = False  # is none itself

    name: str
    state: str
    figures: dict[str, float]


def run(tests: Iterable[str], folder: Path) -> Iterator[TestRun]:
    """Run tests, those of the package and those of the docs in a process each, for some files have the same names.

    Args:
        tests: Files, or ``file::test``.
        folder: For what pytest writes.
    """
    asked = dict.fromkeys(tests)
    for root in dict.fromkeys(Path(test).parts[0] for test in asked):
        results = folder / f"{root}.xml"
        command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={results}", "-o", "junit_family=xunit1"]
        chosen = [test for test in asked if Path(test).parts[0] == root]
        subprocess.run([*command, *chosen], cwd=CHECKOUT, env=environment_of(CHECKOUT), check=False)
        yield from (_read(case) for case in etree.parse(results).iter("testcase"))


def of_promise(runs: Iterable[TestRun], tests: Iterable[str]) -> list[TestRun]:
    """Return the runs of some tests.

    Args:
        runs: All of them.
        tests: Files, or ``file::test``.
    """
    asked = set(tests)
    return [r for r in runs if asked & {r.name, r.name.partition("::")[0]}]


def _read(case: etree._Element) -> TestRun:
    states = {child.tag for child in case}
    state = "failed" if states & set(BAD) else "skipped" if "skipped" in states else "passed"
    figures = {p.get("name"): float(p.get("value")) for p in case.iter("property")}
    return TestRun(f"{case.get('file')}::{case.get('name').partition('[')[0]}", state, figures)
