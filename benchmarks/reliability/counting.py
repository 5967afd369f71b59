"""Counts what a run of pytest tries: each case of a test, and each input of a property test."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator
from typing import Any

import pytest
from hypothesis import is_hypothesis_test
from hypothesis.errors import UnsatisfiedAssumption


class Tries:
    """A plugin of pytest that counts.

    Attributes:
        tried: Number of tries, by case.
        failed: Cases in which a try did not hold; the run of a case ends with the first one.
    """

    def __init__(self) -> None:
        self.tried: Counter[str] = Counter()
        self.failed: set[str] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_pyfunc_call(self, pyfuncitem: pytest.Function) -> Generator[None, object, object]:
        """Count the inputs that a property test draws, while it runs."""
        handle = getattr(pyfuncitem.obj, "hypothesis", None)
        if handle is None or not is_hypothesis_test(pyfuncitem.obj):
            return (yield)
        inner = handle.inner_test
        handle.inner_test = self._counted(inner, pyfuncitem.nodeid)
        try:
            return (yield)
        finally:
            handle.inner_test = inner

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Count a case that draws no inputs, and keep those that failed."""
        if report.failed:
            self.failed.add(report.nodeid)
        if report.failed or (report.when == "call" and report.passed):
            self.tried[report.nodeid] = max(self.tried[report.nodeid], 1)

    def _counted(self, inner: Callable[..., None], case: str) -> Callable[..., None]:
        def counted(*given: Any, **named: Any) -> None:
            if case in self.failed:  # only looks for a smaller input
                return inner(*given, **named)
            try:
                inner(*given, **named)
            except UnsatisfiedAssumption:  # not an input of this test
                raise
            except Exception:
                self.failed.add(case)
                self.tried[case] += 1
                raise
            self.tried[case] += 1

        return counted
