"""A fleet and a tuning on the workers of a scheduler: what one process makes of them."""

from dataclasses import replace

import pytest

from cdia_pin.campaigns import tune
from cdia_pin.fleet import FleetMap, FleetStore, add_logs
from tests.cluster.test_campaign_on_workers import SPEC
from tests.fleet.conftest import DAYS
from tests.processes import worker

TUNED = replace(
    SPEC, rate=100.0, repeats=2, healthy=210.0, settings=(("bandwidth", (30.0,)), ("debounce", (1, 4)))
)


@pytest.fixture(scope="module")
def workers(scheduler):
    with worker(scheduler), worker(scheduler):
        yield scheduler


def test_logs_are_added_by_workers_as_by_one_process(workers, small_fleet, tmp_path):
    fleet = FleetMap.read(small_fleet.map)
    shared, alone = (FleetStore.at(tmp_path / name, make=True) for name in ("shared", "alone"))
    told = []
    added = add_logs(shared, fleet, scheduler=workers, progress=lambda sentence, _: told.append(sentence))
    assert len(added.added) == DAYS
    assert told
    add_logs(alone, fleet)
    assert rows(shared) == rows(alone)


def rows(store: FleetStore) -> list[dict[str, str]]:
    """Return the rows as text, so that NaN equals NaN, without when they were added."""
    kept = [{k: str(v) for k, v in row.items() if k != "added"} for row in store.table().to_pylist()]
    return sorted(kept, key=lambda row: (row["log"], row["effect"], row["joints"], row["parameter"]))


def test_a_monitor_is_tuned_by_workers_as_by_one_process(workers, tmp_path):
    shared = tune(TUNED, 2.0, tmp_path / "shared", scheduler=workers)
    alone = tune(TUNED, 2.0, tmp_path / "alone", workers=1)
    assert str(shared.to_dict()) == str(alone.to_dict())
