"""The page about scale: what was measured, what follows for many logs and runs, and what breaks first."""

from __future__ import annotations

from benchmarks.markdown import table
from benchmarks.publishing import made_by
from benchmarks.scale.costs import ARMS, DAYS, ITEMS, EngineCost, LogCost, ScenarioCost
from cdia_pin.campaigns.run_store import WRITE_EVERY
from cdia_pin.cluster.pace import duration_words
from cdia_pin.viewers.words import number

LOGS, RUNS = 10**5, 10**6
WORKERS = (1, 10, 100, 1000)
LEAST_GAIN, MOST_OVERHEAD = (
    1.8,
    0.05,
)  # [1], of two workers over one; of the engine's time in that of the work
LINK = 125e6  # [B/s], of the coordinator: one gigabit a second
MEMORY = 16e9  # [B], of the coordinator

Gain = tuple[int, float, float]

TEMPLATE = """# Scale: what many logs and many runs need

{made} Costs are times of the processor at a load of {load:.1f}; an idle machine needs less, because its memory is not
shared.

Two kinds of work are shared by workers: the logs of a fleet, and the runs of a campaign. Each item is independent.
A coordinator holds a few items for each thread on their way (`cdia_pin.cluster`), takes each result as it comes, and
writes it.

## Measured

{measured}

A log is that of the demo, as one of a fleet: [fleet.md](fleet.md) says what is fitted to it. A run is 10 s of a UR5 at
1 kHz under a monitor, and the two runs without a monitor that its tracking is compared with. The median of {arms} arms
counts, after everything is compiled. What is compiled is kept on the disk of each machine, so that a new machine spends
some minutes once.

{gain}

## What follows

Times are the measured ones shared by the workers. The column of the engine tells how busy the coordinator is.

{logs}

{runs}

The last arms end at different times: count one arm more for each worker. That is {last} here, and matters only where a
worker makes few of them.

## What breaks first

{breaks}
"""


def page(
    log: LogCost, run: ScenarioCost, engine: EngineCost, load: float, gain: Gain | None, command: str
) -> str:
    """Return the page.

    Args:
        log: Of a log.
        run: Of a scenario.
        engine: Of the engine.
        load: Load of the machine while these costs were measured [1].
        gain: Number of runs, and the times of one worker and of two [s]; None if they were not measured.
        command: What made the page.
    """
    return TEMPLATE.format(
        made=made_by(command, ("distributed", "pyarrow", "pin")),
        load=load,
        measured=_measured(log, run, engine),
        arms=ARMS,
        gain=_gain(gain),
        logs=_needs(
            f"{LOGS:,} logs of {log.samples} samples", LOGS, log.seconds, LOGS, engine.item, log.bytes
        ),
        runs=_needs(
            f"{RUNS:,} runs of 10 s, {run.runs} an arm",
            RUNS,
            run.seconds,
            RUNS // run.runs,
            engine.item,
            (run.item + run.result) / run.runs,
        ),
        last=duration_words(run.seconds * run.runs),
        breaks=_breaks(log, run, engine),
    )


def _measured(log: LogCost, run: ScenarioCost, engine: EngineCost) -> str:
    share = engine.item / (run.seconds * run.runs)
    of_log = engine.item / log.seconds
    rows = [
        ("a log: read", f"{1e3 * log.read:.0f} ms"),
        ("a log: check", f"{1e3 * log.check:.0f} ms"),
        ("a log: all that `cdia fleet add` does with it", f"{1e3 * log.add:.0f} ms"),
        ("a log: file", f"{log.bytes / 1e3:.0f} kB, {log.samples} samples"),
        ("a log: in the store", f"{log.stored / 1e3:.1f} kB, one file"),
        (
            f"a log: in the trend, of {DAYS} logs of a robot",
            f"{1e3 * log.trend:.1f} ms, {log.trend_memory / 1e3:.0f} kB",
        ),
        ("an arm: its monitor learns", f"{run.learn:.2f} s"),
        ("a run", f"{run.run:.2f} s"),
        ("a run with its share of the learning", f"{run.seconds:.2f} s"),
        ("an arm: sent to a worker, and back", f"{run.item / 1e3:.1f} kB, {run.result / 1e3:.1f} kB"),
        ("a run in Parquet", f"{run.parquet:.0f} B"),
        (
            "a run while the result is put together",
            f"{run.summary / 1e3:.1f} kB, {1e6 * run.summary_time:.0f} µs",
        ),
        (f"the engine: the coordinator for an item, mean of {ITEMS}", f"{1e3 * engine.item:.1f} ms"),
        ("the engine: until the first result", f"{engine.start:.1f} s"),
        (
            f"the engine in the time of an arm of {run.runs} runs, target ≤ {MOST_OVERHEAD:.0%}",
            f"{share:.2%}",
        ),
        (f"the engine in the time of a log, target ≤ {MOST_OVERHEAD:.0%}", f"{of_log:.2%}"),
    ]
    return table(("what", "cost"), rows)


def _gain(gain: Gain | None) -> str:
    if gain is None:
        return "`python -m benchmarks.scale --speed-up 1000` also measures two workers beside one."
    runs, one, two = gain
    met = "yes" if one / two >= LEAST_GAIN else "**no**"
    heads = ("runs", "one worker", "two workers", "gain", "target", "met")
    row = (runs, f"{one:.0f} s", f"{two:.0f} s", f"{one / two:.2f}", f"≥ {LEAST_GAIN}", met)
    return table(heads, [row])


def _needs(what: str, count: int, seconds: float, items: int, item: float, size: float) -> str:
    """Return what many of a kind need on several numbers of workers."""
    heads = (what, "time", "engine busy", "moved", "moved a second")
    rows = []
    for workers in WORKERS:
        work, engine = count * seconds / workers, items * item
        time = max(work, engine)
        rows.append(
            (
                f"{workers} worker{'s' * (workers > 1)}",
                duration_words(time),
                f"{min(engine / time, 1.0):.1%}",
                f"{count * size / 1e9:.1f} GB",
                f"{number(count * size / time / 1e3, 2)} kB",
            )
        )
    return table(heads, rows)


def _breaks(log: LogCost, run: ScenarioCost, engine: EngineCost) -> str:
    busy_logs, busy_runs = log.seconds / engine.item, run.seconds * run.runs / engine.item
    link = LINK * log.seconds / log.bytes
    held, files = MEMORY / run.summary, 86400 / WRITE_EVERY
    limits = [
        (
            busy_logs,
            f"""**The coordinator** takes {1 / engine.item:.0f} items a second. It is busy all the time
   at {busy_logs:.0f} workers that fit logs, and at {busy_runs:.0f} that make runs. More workers then wait. Longer
   logs, and more runs of an arm, move this limit up in proportion.""",
        ),
        (
            link,
            f"""**The disk of the logs**: {link:.0f} workers read one gigabit a second. A fleet sends the names of its
   logs, so a shared disk has to deliver them.""",
        ),
    ]
    (_, first), (_, second) = sorted(limits)
    return f"""1. {first}
2. {second}
3. **The result of a campaign** is put together in memory, {run.summary / 1e3:.1f} kB a run: {RUNS:,} runs take
   {RUNS * run.summary / 1e9:.1f} GB and {duration_words(RUNS * run.summary_time)}. A coordinator of
   {MEMORY / 1e9:.0f} GB holds {held / 1e6:.1f} million runs. Beyond that, read the
   Parquet files with DuckDB, which does not hold them all.
4. **The trend** runs in one process: {LOGS:,} logs take {duration_words(LOGS * log.trend)}, and
   {LOGS * log.trend_memory / 1e9:.1f} GB of memory. The store then has {LOGS:,} files of
   {LOGS * log.stored / 1e9:.1f} GB.
5. **Files**: a campaign writes one every {WRITE_EVERY:.0f} s, {files:.0f} a day, {run.parquet:.0f} B a run. {RUNS:,}
   runs are {RUNS * run.parquet / 1e9:.1f} GB.

A worker that is lost costs what it had begun: one arm, {duration_words(run.seconds * run.runs)} here. If one of 1,000
workers is lost in each hour, that is {run.seconds * run.runs / 3600 / 1000:.4%} of the work."""
