"""A campaign: the same plan is the same runs, and none is lost or made twice."""

import dataclasses
import json
from pathlib import Path

import duckdb
import numpy as np
import pandas as pd
import pytest

from cdia_pin.campaigns import (
    CampaignError,
    RunRow,
    RunStore,
    campaign,
    plan_text,
    read_spec,
    run_campaign,
    tune,
    tuning,
)
from cdia_pin.campaigns.campaign_spec import spec_from
from cdia_pin.campaigns.closed_loop import ClosedLoop
from cdia_pin.campaigns.scenario import planned
from cdia_pin.campaigns.scenario_run import described
from cdia_pin.campaigns.watched_run import taught, watched
from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import CdiaError
from cdia_pin.robot import load_robot

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
ARM = {"robots": "double_pendulum", "rate": 250.0, "healthy_runs": 1, "healthy_duration": 8.0}
FAULT = {"terms": "viscous_friction@*: coefficient=1, after=3", "share": [0.1, 0.4]}
SMALL = {
    **ARM,
    "repeats": 2,
    "duration": 7.0,
    "healthy": 4.0,
    "bank": ["coulomb_friction", "viscous_friction"],
    "faults": [FAULT],
}
PLAN = """
robots = "double_pendulum"
rate = 250.0
healthy_runs = 1
healthy_duration = 8.0
repeats = 2
duration = 7.0
healthy = 4.0
bank = ["coulomb_friction", "viscous_friction"]
[[faults]]
terms = "viscous_friction@*: coefficient=1, after=3"
share = [0.1, 0.4]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A campaign that was run once."""
    out = tmp_path_factory.mktemp("campaign") / "runs"
    run_campaign(spec_from(SMALL), out, workers=1)
    return out


def test_a_plan_is_read_and_written_back(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN, encoding="utf-8")
    spec = read_spec(tmp_path / "plan.toml")
    assert spec == spec_from(SMALL)
    again = dataclasses.replace(spec, settings=(("accommodate", (False,)), ("bandwidth", (15.0, 30.0))))
    (tmp_path / "again.toml").write_text(plan_text(again), encoding="utf-8")
    assert read_spec(tmp_path / "again.toml") == again


def test_the_plan_that_ships_can_be_run():
    spec = read_spec(EXAMPLES / "friction.toml")
    spec.check()
    assert sum(len(b.scenarios) for b in planned(spec)) == 20 * (1 + 3 + 1 + 1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"robot": "ur5"}, "unknown key of a campaign 'robot'; did you mean robots"),
        ({"repeats": 2.5}, "repeats takes a value of type int, given 2.5"),
        ({"robots": []}, "a campaign needs a robot"),
        ({"faults": [], "healthy": 0}, "needs faults, or healthy runs"),
        ({"faults": [{"term": "payload: mass=1"}]}, "unknown key of a fault 'term'"),
        ({"faults": [{"terms": "frictions@*: level=1"}]}, "unknown effect 'frictions'"),
        ({"settings": {"margin": -1.0}}, "margin must be above 0"),
        ({"model_error": 0.7}, "between 0 and 0.5"),
        ({"speed": [0.6, 1.5]}, "at most 1, given 1.5"),
        ({"engine": ["momentum"]}, "engine takes a value of type str"),
    ],
)
def test_what_a_plan_cannot_state_is_said_in_one_line(change, said):
    with pytest.raises(CdiaError) as caught:
        spec_from({**SMALL, **change}).check()
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_settings_are_compared_on_the_same_arms_and_faults():
    spec = spec_from({**SMALL, "settings": {"bandwidth": [15.0, 30.0], "debounce": [2, 5]}})
    batches = list(planned(spec))
    assert batches == list(planned(spec))
    assert len(batches) == 2 * 4
    numbers = [s.number for b in batches for s in b.scenarios]
    assert numbers == list(range(len(numbers)))
    assert len({b.arm.loop.seed for b in batches}) == 2
    for repeat in (batches[:4], batches[4:]):
        assert len({tuple(s.faults for s in b.scenarios) for b in repeat}) == 1


def test_the_speed_of_the_motion_can_be_swept():
    spec = spec_from({**SMALL, "repeats": 1, "speed": [0.2, 0.6]})
    spec.check()
    loops = [b.arm.loop for b in planned(spec)]
    assert [loop.speed for loop in loops] == [0.2, 0.6]
    robot = Dynamics(load_robot("double_pendulum"))
    slow, usual = (np.abs(ClosedLoop(robot, x).motion(0, 7.0)(np.linspace(0, 7, 500)).v).max() for x in loops)
    assert slow < 0.5 * usual
    assert {described(b.arm, b.scenarios[0]).speed for b in planned(spec)} == {0.2, 0.6}
    assert list(planned(spec_from(SMALL))) == list(planned(spec_from({**SMALL, "speed": 0.6})))


def test_what_came_of_each_run_is_a_row(folder):
    rows = RunStore.opened(folder).read()
    assert list(rows) == list(range(6))
    assert [r.error for r in rows.values()] == [""] * 6
    healthy, small, large = (rows[k] for k in range(3))
    assert (healthy.fault, healthy.healthy_time, healthy.false_alarms) == ("", 4.0, 0)
    assert len(healthy.peaks) == 3  # the first second is the filters'
    assert large.detected and 0 < large.delay < 0.5
    assert large.tracking < large.tracking_alone
    assert np.nanmin(small.delays) >= np.nanmin(large.delays)


def test_a_size_is_a_share_of_the_torque_of_the_joint(folder):
    spec = RunStore.opened(folder).spec
    batch = next(planned(spec))
    small, large = (watched(batch.arm, s).faults[0].theta[0] for s in batch.scenarios[1:])
    assert large == pytest.approx(4 * small)


def test_duckdb_and_pandas_read_the_runs(folder):
    files = str(folder / "runs" / "*.parquet")
    (counts,) = duckdb.sql(f"select count(*), count(distinct number), max(share) from '{files}'").fetchall()
    assert counts == (6, 6, 0.4)
    table = pd.read_parquet(folder / "runs")
    assert list(table.columns) == [f.name for f in dataclasses.fields(RunRow)]
    assert table.onset.isna().sum() == 2  # of the healthy runs


def test_the_result_has_every_interval(folder):
    found = campaign.kept_result(RunStore.opened(folder)).to_dict()
    assert json.loads(json.dumps(found))["schema"] == "cdia-campaign/1"
    assert [c["fault"] for c in found["cells"]] == ["healthy", "viscous_friction", "viscous_friction"]
    whole = found["whole"][0]
    assert whole["false_alarms"]["lower"] <= whole["false_alarms"]["value"] <= whole["false_alarms"]["upper"]
    rates = [p["false_alarms_per_hour"]["value"] for p in found["operating_points"][""]]
    shares = [p["detected"]["value"] for p in found["operating_points"][""]]
    assert shares == sorted(shares, reverse=True)
    assert rates[0] >= rates[-1]
    assert sum(found["names"]["viscous_friction"].values()) == 4


def test_a_run_made_again_is_the_same_run(folder):
    store = RunStore.opened(folder)
    taught.cache_clear()
    arm, scenario = campaign.found_scenario(store.spec, 5)
    made, row = watched(arm, scenario), store.read()[5]
    assert made.scores(2).delays == pytest.approx(row.delays, nan_ok=True)
    with pytest.raises(CampaignError, match="runs 0 to 5"):
        campaign.found_scenario(store.spec, 6)


def test_an_interrupted_campaign_goes_on_and_makes_no_run_twice(tmp_path, monkeypatch):
    made = []

    def run(batch):
        made.append([s.number for s in batch.scenarios])
        if len(made) == 3:
            raise KeyboardInterrupt
        return [described(batch.arm, s) for s in batch.scenarios]

    monkeypatch.setattr(campaign, "run_batch", run)
    spec = spec_from({**SMALL, "repeats": 5})
    with pytest.raises(KeyboardInterrupt):
        run_campaign(spec, tmp_path, workers=1)
    assert list(RunStore.opened(tmp_path).read()) == list(range(6))
    found = run_campaign(spec, tmp_path, workers=1)
    assert (found.runs, found.planned) == (15, 15)
    assert [numbers[0] for numbers in made] == [0, 3, 6, 6, 9, 12]
    counted = duckdb.sql(f"select count(*) from '{tmp_path}/runs/*.parquet'").fetchall()
    assert counted == [(15,)]


def test_a_run_that_fails_is_a_row_with_its_reason_and_is_made_again(tmp_path, monkeypatch):
    def fail(batch):
        raise RuntimeError("no power")

    spec = spec_from(SMALL)
    monkeypatch.setattr(campaign, "run_batch", fail)
    found = run_campaign(spec, tmp_path, workers=1)
    assert {why for _, why in found.worst} == {"could not be made: RuntimeError: no power"}
    monkeypatch.setattr(campaign, "run_batch", lambda b: [described(b.arm, s) for s in b.scenarios])
    assert sum(cell.failed for cell in run_campaign(spec, tmp_path, workers=1).whole) == 0


def test_a_repr_is_one_short_line(folder):
    store = RunStore.opened(folder)
    found, rows = campaign.kept_result(store), store.read()
    for shown in (store.spec, rows[2], found, found.cells[0]):
        assert repr(shown).startswith(type(shown).__name__ + "(")
        assert len(repr(shown)) < 200


def test_a_folder_holds_one_campaign(folder, tmp_path):
    with pytest.raises(CampaignError, match="another campaign"):
        run_campaign(spec_from({**SMALL, "seed": 9}), folder, workers=1)
    with pytest.raises(CampaignError, match="holds no campaign"):
        RunStore.opened(tmp_path)
    with pytest.raises(CampaignError, match="holds the runs of a campaign, expected those of a tuning"):
        RunStore.opened(folder, "tuning")
    document = json.loads((folder / "campaign.json").read_text())
    (tmp_path / "campaign.json").write_text(json.dumps({**document, "version": "0.0"}))
    with pytest.raises(CampaignError, match=r"made by cdia-pin 0\.0"):
        RunStore.opened(tmp_path)


def test_a_plan_with_too_few_healthy_seconds_is_refused_before_any_run(tmp_path, monkeypatch):
    spec = spec_from({**SMALL, "settings": {"bandwidth": [30.0], "debounce": [1, 4]}})
    monkeypatch.setattr(tuning, "watch_group", lambda batches: pytest.fail("a run was made"))
    # Two arms: 3 s of each healthy run and 2 s before each of the two faults, without the first second.
    with pytest.raises(CdiaError, match=r"^14 healthy seconds are too few for a threshold, 400 are needed"):
        tune(spec, 1.0, tmp_path / "runs", workers=1)
    assert not (tmp_path / "runs").exists()


def test_the_plan_tells_the_healthy_seconds_of_its_runs(folder):
    store = RunStore.opened(folder)
    assert tuning.healthy_seconds(store.spec) == sum(len(row.peaks) for row in store.read().values())
