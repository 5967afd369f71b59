"""Courses of known noise: how often chance gives an alarm, and how often an interval holds the size of a change.

Usage:
    python -m benchmarks.fleet.tails              # two minutes
    python -m benchmarks.fleet.tails --freedom 4  # with another number of degrees of freedom of a log

The values of logs have longer tails than normal ones, because their motions differ, and may follow those of the logs
before, as a season does. These draws need no plant, so they are many. `FREEDOM_OF_A_LOG` was chosen on other draws of
them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from benchmarks.markdown import table
from cdia_pin.fleet import step_search
from cdia_pin.fleet.alarm_limit import alarm_limit
from cdia_pin.fleet.onset import find_onset
from cdia_pin.regression.intervals import NORMAL_95

Array = NDArray[np.float64]

SEED = 200_000
LOGS = 60  # of a course [1]
COURSES = 2000  # of each noise [1]
CHANGED = 200  # courses with a change of each kind [1]
EXPECTED = (0.1, 0.01)  # false alarms of a course, as stated [1]
LARGE = (4.0, 40.0)  # sizes of a change, in standard deviations of a log [1]
GROWTHS = (1, 20)  # logs in which a change grows [1]
Draw = Callable[[np.random.Generator], Array]
NOISE: dict[str, Draw] = {
    "normal": lambda rng: rng.standard_normal(LOGS),
    "Laplace": lambda rng: rng.laplace(size=LOGS) / np.sqrt(2),
    "Student, 5 degrees of freedom": lambda rng: rng.standard_t(5, LOGS) / np.sqrt(5 / 3),
    "Student, 3 degrees of freedom": lambda rng: rng.standard_t(3, LOGS) / np.sqrt(3),
    "normal, follows its neighbour by 0.3": lambda rng: _following(rng, 0.3),
    "normal, follows its neighbour by 0.6": lambda rng: _following(rng, 0.6),
}


def tails() -> str:
    """Return the table."""
    head = (
        "noise of a course",
        *(f"alarms where {e * COURSES:g} are stated" for e in EXPECTED),
        *(
            f"size of {size:g} sd {'at once' if logs == 1 else f'in {logs} logs'}"
            for size in LARGE
            for logs in GROWTHS
        ),
    )
    return table(head, (tuple(_row(name, draw, k)) for k, (name, draw) in enumerate(NOISE.items())))


def _row(name: str, draw: Draw, number: int) -> Iterator[object]:
    rng = np.random.default_rng([SEED, number])
    yield name
    surest = np.array([_surest(draw(rng), _columns(rng)) for _ in range(COURSES)])
    for expected in EXPECTED:
        yield int(np.sum(surest > alarm_limit(LOGS / expected)))
    for size in LARGE:
        for logs in GROWTHS:
            held = sum(_holds(draw(rng), _columns(rng), size, logs, rng) for _ in range(CHANGED))
            yield f"{100 * held / CHANGED:.0f} %"


def _following(rng: np.random.Generator, share: float) -> Array:
    """Return values of variance one, each of which holds a share of the one before it, shape (LOGS,)."""
    values = rng.standard_normal(LOGS)
    for k in range(1, LOGS):
        values[k] = share * values[k - 1] + np.sqrt(1 - share**2) * values[k]
    return values


def _columns(rng: np.random.Generator) -> Array:
    return np.column_stack([np.ones(LOGS), rng.standard_normal(LOGS)])


def _surest(values: Array, columns: Array) -> float:
    steps = step_search.find_steps(values, np.full(LOGS, 1e-3), columns, range(LOGS + 1))
    return max(abs(step.z) for step in steps.values())


def _holds(noise: Array, columns: Array, size: float, logs: int, rng: np.random.Generator) -> bool:
    began = int(rng.integers(LOGS // 3, 2 * LOGS // 3))
    values = noise + size * np.clip((np.arange(LOGS) - began + 1) / logs, 0.0, 1.0)
    onset = find_onset(values, np.full(LOGS, 1e-3), columns)
    return abs(onset.size - size) < NORMAL_95 * onset.deviation


def main() -> None:
    """Print the table."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.fleet.tails", description="Draw courses of known noise."
    )
    usual = step_search.FREEDOM_OF_A_LOG
    given.add_argument(
        "--freedom", type=int, default=usual, help="degrees of freedom that a log of a step adds"
    )
    step_search.FREEDOM_OF_A_LOG = given.parse_args().freedom
    print(tails())


if __name__ == "__main__":
    main()
