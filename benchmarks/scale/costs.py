"""Costs of one log, one scenario and one item of the engine, as processor times: other work does not count."""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from itertools import islice
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import numpy as np

from cdia_pin.campaigns.campaign_result import summarised
from cdia_pin.campaigns.campaign_spec import CampaignSpec, FaultCase
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.run_store import RunStore
from cdia_pin.campaigns.scenario import Batch, planned
from cdia_pin.campaigns.scenario_run import run_batch
from cdia_pin.campaigns.watched_run import taught
from cdia_pin.cluster import run_each
from cdia_pin.fleet import FleetMap, FleetStore, fleet_trend
from cdia_pin.fleet.log_rows import FleetLog, Row, rows_of
from cdia_pin.logs import check_log, read_log
from cdia_pin.logs.readers.checksum import sha256_of
from cdia_pin.resources import logs_dir
from cdia_pin.robot import load_robot
from cdia_pin.whole_files import write_whole

ARM, LOG = "ur5", "demo_ur5.csv"
REPEATS = 3  # of a measurement; the median counts
ARMS = 4  # whose runs are measured
ITEMS = 1000  # items without work
DAYS, BEGIN = (
    365,
    datetime(2025, 1, 1, tzinfo=UTC),
)  # logs in the store whose trend is measured: a year of one robot
VALUES = ("value", "ci95_low", "ci95_high", "ci95_statistical_low", "ci95_statistical_high")
SPEC = CampaignSpec(
    robots=(ARM,),
    repeats=ARMS + 1,  # one to compile what the others need
    healthy=10.0,
    duration=10.0,
    faults=(FaultCase(("coulomb_friction@*: level=1, after=4",), (0.1, 0.2, 0.5)),),
)


@dataclass(frozen=True)
class LogCost:
    """Cost of a log of a fleet.

    Attributes:
        samples: Number of its samples.
        bytes: Size of its file [B].
        read: Time to read it [s].
        check: Time to check it [s].
        add: Time of all that `cdia fleet add` does with it, reading and checking included [s].
        stored: Size of its file in the store [B].
        trend: Time of the trend for it, in a store of many [s].
        trend_memory: Memory of the trend for it [B].
    """

    samples: int
    bytes: int
    read: float
    check: float
    add: float
    stored: float
    trend: float
    trend_memory: float

    @property
    def seconds(self) -> float:
        """Time to add it [s]."""
        return self.add


@dataclass(frozen=True)
class ScenarioCost:
    """Cost of a scenario.

    Attributes:
        learn: Time in which a monitor learns from its arm [s].
        run: Time of a run of 10 s, with the two runs that its tracking is compared with [s].
        runs: Number of runs of an arm.
        item: Size of an arm with its runs, as it is sent to a worker [B].
        result: Size of what is sent back [B].
        parquet: Size of a run in Parquet [B].
        summary: Memory of a run while the result is put together [B].
        summary_time: Time of a run while the result is put together [s].
    """

    learn: float
    run: float
    runs: int
    item: int
    result: int
    parquet: float
    summary: float
    summary_time: float

    @property
    def seconds(self) -> float:
        """Time of a run with its share of the learning [s]."""
        return self.learn / self.runs + self.run


@dataclass(frozen=True)
class EngineCost:
    """Cost of the engine.

    Attributes:
        start: Time until the first result of two workers of this machine [s].
        item: Time of the coordinator for an item, with the data of a scenario's arm [s].
    """

    start: float
    item: float


def log_cost() -> LogCost:
    """Return what the log that ships costs as one of a fleet."""
    robot, file = load_robot(ARM), logs_dir() / LOG
    log = read_log(file, robot)
    with tempfile.TemporaryDirectory() as folder:
        plan = Path(folder) / "fleet.toml"
        write_whole(plan, f'[robots.{ARM}]\nrobot = "{ARM}"\nlogs = ["{file}"]\n')
        one = FleetLog(file, FleetMap.read(plan).robot_of(file), sha256_of([file]))
        store, rows = FleetStore.at(Path(folder) / "store", make=True), list[Row]()

        def add() -> None:
            rows[:] = rows_of(one)
            store.write(rows)

        spent = _time(add)
        year = FleetStore.at(Path(folder) / "year", make=True)
        files = [year.write(_later(rows, day)).stat().st_size for day in range(DAYS)]
        fleet_trend(year)
        trend, memory = _both(lambda: fleet_trend(year))
    return LogCost(
        samples=len(log.time),
        bytes=file.stat().st_size,
        read=_time(lambda: read_log(file, robot)),
        check=_time(lambda: check_log(log, robot)),
        add=spent,
        stored=sum(files) / DAYS,
        trend=trend / DAYS,
        trend_memory=memory / DAYS,
    )


def _later(rows: list[Row], day: int) -> list[Row]:
    """Return the rows of the log of another day, with other values."""
    rng, when = np.random.default_rng(day), BEGIN + timedelta(days=day)
    head = {"log": f"{when:%Y-%m-%d}.csv", "sha256": f"{day:08x}".ljust(64, "0"), "recorded": when}
    return [row | head | _other(row, rng.standard_normal()) for row in rows]


def _other(row: Row, draw: float) -> Row:
    """Return the value of a row and its intervals, moved by a share of them."""
    low, high = row["ci95_low"], row["ci95_high"]
    if not (isinstance(low, float) and isinstance(high, float)):
        return {}
    moved = draw * (high - low) / 4
    return {key: value + moved for key in VALUES if isinstance(value := row[key], float)}


def scenario_cost() -> ScenarioCost:
    """Return what a scenario costs, once what it needs is compiled."""
    first, *batches = planned(SPEC)
    run_batch(first)
    learned, ran, rows = [], [], []
    for batch in batches:
        learned.append(_spent(lambda batch=batch: taught(batch.arm)))
        ran.append(_spent(lambda batch=batch: rows.append(run_batch(batch))) / len(batch.scenarios))
    flat = [row for of_arm in rows for row in of_arm]
    with tempfile.TemporaryDirectory() as folder:
        store = RunStore.made(folder, SPEC)
        with store.writing():
            store.add(_many(flat))
        size = sum(f.stat().st_size for f in Path(folder).rglob("*.parquet")) / ITEMS
        seconds, memory = _both(lambda: summarised(SPEC, store.read().values(), ITEMS))
    return ScenarioCost(
        learn=median(learned),
        run=median(ran),
        runs=len(first.scenarios),
        item=len(pickle.dumps(batches[0])),
        result=len(pickle.dumps(rows[0])),
        parquet=size,
        summary=memory / ITEMS,
        summary_time=seconds / ITEMS,
    )


def engine_cost() -> EngineCost:
    """Return what the engine adds to each item on two workers."""
    batches = list(planned(replace(SPEC, repeats=ITEMS)))
    begin = perf_counter()
    running = run_each(echo, batches, workers=2)
    next(running)
    started, busy = perf_counter(), process_time()
    for _ in running:
        pass
    return EngineCost(started - begin, (process_time() - busy) / (len(batches) - 1))


def echo(batch: Batch) -> list[RunRow]:
    """Return results of the usual size without work, on a worker."""
    return [
        RunRow(
            s.number,
            ARM,
            0.03,
            0.01,
            "",
            s.repeat,
            0,
            "",
            "",
            "",
            0.0,
            peaks=(0.4,) * 10,
            delays=(0.01,) * 41,
        )
        for s in batch.scenarios
    ]


def speed_up(runs: int) -> tuple[int, float, float]:
    """Return the number of runs, and the times that one worker and two need for them [s].

    Args:
        runs: How many at least.
    """
    first, *some = islice(
        planned(replace(SPEC, repeats=10**6)), 1 + -(-runs // len(next(planned(SPEC)).scenarios))
    )
    list(run_each(run_batch, [first] * 2, workers=2))  # compiles
    spent = []
    for workers in (1, 2):
        begin = perf_counter()
        for _ in run_each(run_batch, some, workers=workers):
            pass
        spent.append(perf_counter() - begin)
    return sum(len(b.scenarios) for b in some), spent[0], spent[1]


def _many(rows: list[RunRow]) -> list[RunRow]:
    """Return as many rows as items, with other numbers in the lists, which make most of a row's size."""
    rng = np.random.default_rng(0)

    def other(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple((np.array(values) * rng.uniform(0.5, 2.0, len(values))).tolist())

    some = ((k, rows[k % len(rows)]) for k in range(ITEMS))
    return [replace(r, number=k, peaks=other(r.peaks), delays=other(r.delays)) for k, r in some]


def _both(work: Callable[[], object]) -> tuple[float, int]:
    """Return time [s] and memory [B] of a piece of work."""
    import tracemalloc

    seconds = _spent(work)
    tracemalloc.start()
    work()
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return seconds, memory


def _time(work: Callable[[], object]) -> float:
    return median(_spent(work) for _ in range(REPEATS))


def _spent(work: Callable[[], object]) -> float:
    begin = process_time()
    work()
    return process_time() - begin
