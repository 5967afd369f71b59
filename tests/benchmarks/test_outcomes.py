"""Outcomes are kept one a line; what an interruption cut short is left out and spoils nothing."""

from dataclasses import dataclass

import pytest

from benchmarks.outcomes import JsonLine, Store


@dataclass(frozen=True)
class Outcome(JsonLine):
    """A case and a number."""

    id: str
    value: float


LAST = Outcome("b", 2.0).to_json() + "\n"


@pytest.mark.parametrize("left", range(len(LAST) + 1))
def test_a_run_goes_on_behind_a_line_cut_short(tmp_path, left):
    store = Store(tmp_path / "outcomes.jsonl", Outcome.from_json)
    store.add(Outcome("a", 1.0))
    with store.path.open("a") as file:
        file.write(LAST[:left])
    store.add(Outcome("c", 3.0))
    whole = {"a", "c"} | ({"b"} if left >= len(LAST) - 1 else set())
    assert set(store.read()) == whole
