"""A campaign on the workers of a scheduler, one of them killed: every run once, and the rows of one process."""

import os
import signal
from dataclasses import replace

import pyarrow.parquet as pq
from distributed import Client

from cdia_pin.campaigns import CampaignSpec, FaultCase, RunStore, run_campaign
from tests.processes import worker

ARMS = 6
SPEC = CampaignSpec(
    robots=("double_pendulum",),
    repeats=ARMS,
    duration=3.0,
    healthy=2.0,
    rate=250.0,
    healthy_runs=1,
    healthy_duration=6.0,
    tracking=False,
    bank=("coulomb_friction", "viscous_friction"),
    faults=(FaultCase(("viscous_friction@*: coefficient=1, after=1.5",), (0.3,)),),
)


def test_a_killed_worker_loses_no_run_and_makes_none_twice(scheduler, tmp_path):
    with worker(scheduler) as first, worker(scheduler):
        with Client(scheduler, set_as_default=False) as client:
            client.wait_for_workers(2)
        told = []

        def killing(sentence: str, portion: float) -> None:
            told.append(sentence)
            if len(told) == 2:
                os.kill(first.pid, signal.SIGKILL)

        found = run_campaign(SPEC, tmp_path / "shared", scheduler=scheduler, progress=killing)
        assert first.wait(10) == -signal.SIGKILL
    assert (found.runs, found.planned) == (2 * ARMS, 2 * ARMS)
    tables = [pq.read_table(file, columns=["number"]) for file in (tmp_path / "shared" / "runs").iterdir()]
    assert sorted(n for t in tables for n in t["number"].to_pylist()) == list(range(2 * ARMS))
    run_campaign(SPEC, tmp_path / "alone", workers=1)
    assert timeless(tmp_path / "shared") == timeless(tmp_path / "alone")


def timeless(folder) -> list[dict[str, object]]:
    """Return the runs as text, so that NaN equals NaN, without the time that they took."""
    rows = RunStore.opened(folder).read().values()
    assert not any(row.error for row in rows)
    return [{k: str(v) for k, v in vars(replace(row, seconds=0.0)).items()} for row in rows]
