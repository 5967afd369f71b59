"""`run_campaign`: make the runs of a plan on many workers, keep them, and say what they show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from cdia_pin.campaigns.campaign_result import CampaignResult, summarised
from cdia_pin.campaigns.campaign_spec import CampaignError, CampaignSpec
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.run_store import RunStore
from cdia_pin.campaigns.scenario import Batch, DrawnArm, Scenario, planned
from cdia_pin.campaigns.scenario_run import described, run_batch
from cdia_pin.cluster import Finished, number_of_workers, run_each
from cdia_pin.progress import Progress, silent


def run_campaign(
    spec: CampaignSpec,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> CampaignResult:
    """Make the runs of a plan that have not been made, and return what all of them show.

    Runs reach the folder as they are made. A campaign that was interrupted goes on where it was.

    Args:
        spec: The plan.
        folder: Where the runs are kept; made if it is not there.
        workers: Number of processes; one a core if omitted.
        scheduler: Address of a running scheduler of Dask, in place of processes of this machine.
        progress: Called with the current work and the share that is done [1].

    Raises:
        CampaignError: If the folder holds another campaign.
        CdiaError: If the plan is not valid, or the scheduler cannot be used.
    """
    number_of_workers(workers, scheduler)  # what is wrong with them is told before anything is written
    spec.check()
    store = RunStore.made(folder, spec)
    done = {number for number, row in store.read().items() if not row.error}
    pending = [b for b in planned(spec) if not {s.number for s in b.scenarios} <= done]

    def tell(sentence: str, portion: float) -> None:
        progress(f"arms: {sentence}", portion)

    with store.writing():
        if pending:
            for one in run_each(run_batch, pending, workers=workers, scheduler=scheduler, progress=tell):
                store.add(rows_of(one, [one.item]))
    return kept_result(store)


def kept_result(store: RunStore) -> CampaignResult:
    """Return what the runs in a folder show.

    Args:
        store: The folder.
    """
    total = sum(len(b.scenarios) for b in planned(store.spec))
    return summarised(store.spec, store.read().values(), total)


def rows_of(finished: Finished[Any, list[RunRow]], batches: Iterable[Batch]) -> list[RunRow]:
    """Return the rows of some arms' runs; with the error that ended all of them, if there was one.

    Args:
        finished: What came of the runs.
        batches: The arms.
    """
    if finished.error is None:
        return finished.result
    return [replace(described(b.arm, s), error=finished.why) for b in batches for s in b.scenarios]


def found_scenario(spec: CampaignSpec, number: int) -> tuple[DrawnArm, Scenario]:
    """Return a run of a plan, to make it again.

    Args:
        spec: The plan.
        number: Number of the run.

    Raises:
        CampaignError: If there is none.
    """
    last = -1
    for batch in planned(spec):
        for scenario in batch.scenarios:
            if scenario.number == number:
                return batch.arm, scenario
            last = scenario.number
    raise CampaignError(f"this campaign has runs 0 to {last}, given {number}")
