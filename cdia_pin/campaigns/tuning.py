"""`tune`: the filter, the debounce and the thresholds of a monitor for a stated rate of false alarms.

Each arm moves once for each filter, with detection switched off, so that its residual is that of the fault alone. From
the residual over the threshold follows what any threshold and any debounce would have said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby, product
from math import inf, isnan, nan
from pathlib import Path
from time import perf_counter

import numpy as np

from cdia_pin.campaigns.alarm_scores import FACTORS, most_peaks
from cdia_pin.campaigns.alarm_tail import AlarmTail, require_enough
from cdia_pin.campaigns.campaign import rows_of
from cdia_pin.campaigns.campaign_result import HOUR
from cdia_pin.campaigns.campaign_spec import CampaignError, CampaignSpec, with_joint
from cdia_pin.campaigns.estimates import quantile, share
from cdia_pin.campaigns.loop_comparison import onset
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.run_store import TUNING, RunStore
from cdia_pin.campaigns.scenario import Batch, planned
from cdia_pin.campaigns.scenario_run import debounce_of, described, settings_words
from cdia_pin.campaigns.tuning_result import TradeOff, TuningResult
from cdia_pin.campaigns.watched_run import watched
from cdia_pin.cluster import number_of_workers, run_each
from cdia_pin.diagnosis import MonitorSettings
from cdia_pin.effects import parse_term
from cdia_pin.errors import CdiaError
from cdia_pin.phrases import one_line
from cdia_pin.progress import Progress, silent
from cdia_pin.robot import load_robot

BANDWIDTHS = (15.0, 30.0, 60.0)  # [1/s], filters that are tried unless the plan names others
DEBOUNCES = (1, 2, 5, 10)  # ticks
NEVER = 10**9  # ticks in a row that no run has: nothing is detected
RATES = (0.01, 0.1, 1.0, 10.0, 100.0)  # [1], of the stated rate, at which the trade-off is shown
DETECTORS = 2  # the threshold, and the detector of faults that last: each has half of the false alarms


def tune(
    spec: CampaignSpec,
    false_alarms: float,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> TuningResult:
    """Choose the filter, the debounce and the threshold that find faults soonest at a stated rate of false alarms.

    Args:
        spec: The arms and the faults; its settings may name values of ``bandwidth`` and ``debounce`` to try.
        false_alarms: Largest rate of false alarms of an arm [1/h], of both detectors together.
        folder: Where the runs are kept; made if it is not there.
        workers: Number of processes; one a core if omitted.
        scheduler: Address of a running scheduler of Dask, in place of processes of this machine.
        progress: Called with the current work and the share that is done [1].

    Returns:
        The settings, and what was given up for them.

    Raises:
        CampaignError: If there are no faults or no healthy runs, the engine is another one, or the folder holds
            another campaign.
        CdiaError: If the plan, or what came of it, has too few healthy seconds for a threshold.
    """
    number_of_workers(workers, scheduler)  # what is wrong with them is told before anything is written
    tried = tuning_spec(spec, false_alarms)
    tried.check()
    require_enough(healthy_seconds(tried))
    store = RunStore.made(folder, tried, TUNING)
    done = {number for number, row in store.read().items() if not row.error}
    groups = [tuple(g) for _, g in groupby(planned(tried), key=_without_debounce)]
    pending = [g for g in groups if not {s.number for b in g for s in b.scenarios} <= done]

    def tell(sentence: str, portion: float) -> None:
        progress(f"arms: {sentence}", portion)

    with store.writing():
        if pending:
            for one in run_each(watch_group, pending, workers=workers, scheduler=scheduler, progress=tell):
                store.add(rows_of(one, one.item))
    return tuned(tried, list(store.read().values()), false_alarms)


def tuning_spec(spec: CampaignSpec, false_alarms: float) -> CampaignSpec:
    """Return the plan of the runs: every filter and debounce, without correction.

    Args:
        spec: The arms and the faults.
        false_alarms: Largest rate of false alarms [1/h].

    Raises:
        CampaignError: If the plan cannot be used for it.
    """
    if not 0 < false_alarms < inf:
        raise CampaignError(f"the rate of false alarms must be above 0 an hour, given {false_alarms}")
    if spec.engine != "momentum":
        raise CampaignError(f"only the engine momentum can be tuned, given {spec.engine}")
    if not (spec.faults and spec.healthy):
        raise CampaignError("tuning needs faults, and healthy runs: healthy = 60.0")
    chosen = (
        {"bandwidth": BANDWIDTHS, "debounce": DEBOUNCES} | dict(spec.settings) | {"accommodate": (False,)}
    )
    last = {"debounce": chosen.pop("debounce")}  # arms that differ in it alone follow each other
    return replace(spec, settings=(*sorted(chosen.items()), *last.items()), tracking=False)


def healthy_seconds(spec: CampaignSpec) -> int:
    """Return the number of healthy seconds that the runs of a plan have for each of its settings, at most.

    Args:
        spec: The plan; it has been checked.
    """
    times = [spec.healthy] * len(spec.robots)
    for robot, case in product(spec.robots, spec.faults):
        arm = load_robot(robot)
        faults = [parse_term(with_joint(text, arm.joints[0]), arm) for text in case.terms]
        times += [min(onset(faults), spec.duration)] * len(case.shares)
    arms = spec.repeats * len(spec.loops(0))
    return arms * sum(most_peaks(time, spec.rate) for time in times)


def watch_group(batches: Sequence[Batch]) -> list[RunRow]:
    """Let an arm move once, and return what each debounce would have said.

    Args:
        batches: Runs of arms that differ in the debounce alone.

    Returns:
        A row for each of their runs.
    """
    first = batches[0].arm
    silenced = replace(
        first, settings=tuple({**dict(first.settings), "debounce": NEVER, "false_alarm_every": 1e300}.items())
    )
    out: list[RunRow] = []
    for k, scenario in enumerate(batches[0].scenarios):
        begin = perf_counter()
        try:
            made, error = watched(silenced, scenario), ""
        except CdiaError as why:
            made, error = None, one_line(why)
        for batch in batches:
            own = batch.scenarios[k]
            if made is None:
                out.append(replace(described(batch.arm, own), error=error))
                continue
            said = made.scores(debounce_of(batch.arm))
            begun = made.onset
            out.append(
                replace(
                    described(batch.arm, own, made.faults),
                    onset=begun if made.faults else nan,
                    healthy_time=min(begun, own.duration),
                    diverged=made.run is None,
                    peaks=said.peaks,
                    delays=said.delays,
                    seconds=(perf_counter() - begin) / len(batches),
                )
            )
    return out


def tuned(spec: CampaignSpec, rows: Sequence[RunRow], false_alarms: float) -> TuningResult:
    """Choose settings from what each filter and debounce would have said.

    Args:
        spec: The plan of the runs.
        rows: The runs.
        false_alarms: Largest rate of false alarms [1/h].
    """
    by_settings: dict[str, list[RunRow]] = {}
    for row in rows:
        if not row.error:
            by_settings.setdefault(row.settings, []).append(row)
    wanted = false_alarms / DETECTORS
    options = [
        trade_off(by_settings[words], wanted, dict(chosen))
        for chosen in spec.combinations()
        if (words := settings_words(chosen)) in by_settings
    ]
    if not options:
        raise CampaignError("no run could be made, so nothing can be chosen")
    best = min(options, key=lambda o: o.time_to_detect)
    usual = MonitorSettings()
    settings: dict[str, float | int] = {
        **{n: v for n, v in best.settings.items() if n != "accommodate"},
        "margin": round(best.factor * usual.margin, 3),
        "noise_margin": round(best.factor * usual.noise_margin, 3),
        "false_alarm_every": HOUR * DETECTORS / false_alarms,
    }
    same = by_settings[settings_words(tuple(best.settings.items()))]
    return TuningResult(
        spec,
        false_alarms,
        settings,
        best,
        tuple(options),
        tuple(trade_off(same, wanted * part, best.settings) for part in RATES),
        sum(bool(r.error) for r in rows),
    )


def trade_off(
    rows: Sequence[RunRow], alarms_per_hour: float, settings: Mapping[str, float | int]
) -> TradeOff:
    """Return the threshold for a rate of false alarms, and how soon it finds the faults.

    Args:
        rows: Runs with the same settings.
        alarms_per_hour: Largest rate of false alarms of the threshold [1/h].
        settings: Their settings.
    """
    tail = AlarmTail.of(rows)
    factor = tail.factor(alarms_per_hour)
    faulty = [r for r in rows if r.fault]
    delays = [delay_at(r, factor) for r in faulty]
    spent = [min(d, r.duration - r.onset) for d, r in zip(delays, faulty, strict=True)]
    return TradeOff(
        settings=dict(settings),
        alarms_per_hour=alarms_per_hour,
        factor=factor,
        extrapolated=tail.is_extrapolated(alarms_per_hour),
        hours=tail.hours,
        detected=share(sum(d < inf for d in delays), len(delays)),
        median_delay=quantile(delays, 0.5),
        late_delay=quantile(delays, 0.9),
        time_to_detect=float(np.mean(spent)) if spent else nan,
    )


def delay_at(row: RunRow, factor: float) -> float:
    """Return the time from onset to detection with another threshold [s]; infinite if there is none.

    Args:
        row: A run with a fault.
        factor: Threshold over that of the monitor [1]; the next greater one of `FACTORS` counts.
    """
    k = int(np.searchsorted(FACTORS, factor - 1e-12))
    if k >= len(FACTORS) or k >= len(row.delays) or isnan(row.delays[k]):
        return inf
    return row.delays[k]


def _without_debounce(batch: Batch) -> tuple[object, ...]:
    settings = tuple(pair for pair in batch.arm.settings if pair[0] != "debounce")
    return (batch.arm.robot, batch.arm.loop, settings)
