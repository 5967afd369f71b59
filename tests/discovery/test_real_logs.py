"""Logs of real arms: each ends with a verdict and a model whose held-out error is lower.

The first half minute of one log of each kind; `python -m benchmarks.measured_logs` reads them all.
"""

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, load_model, load_robot, read_log, save_model
from cdia_pin.discovery import DiscoveryVerdict, discover
from cdia_pin.selection import DiscoverySettings
from tests.hidden_plants import MEASURED

LOGS = [
    ("panda", "panda/exciting.csv"),
    ("ur10", "ur10/exciting.csv"),
    *(("ur10e", f"ur10e/{name}.csv") for name in ("point_to_point", "jointwise_2")),
]
HALF_MINUTE = 30.0  # [s]
A_FEW = DiscoverySettings(most_effects=8)  # lower the error nearly as far as all that a long search finds
pytestmark = pytest.mark.skipif(
    not MEASURED.is_dir(), reason="the measured logs (../shared/data) are not here"
)


def load(robot, path):
    arm = load_robot(MEASURED / "ur10e/ur10e.urdf" if robot == "ur10e" else robot)
    gains = MEASURED / "ur10e/drive_gains.json" if robot == "ur10e" else None
    return arm, read_log(MEASURED / path, arm, gains=gains)


@pytest.mark.parametrize(("robot", "path"), LOGS, ids=[p for _, p in LOGS])
def test_each_log_ends_with_a_verdict_and_a_better_model(robot, path, tmp_path):
    arm, log = load(robot, path)
    log = log.slice(0, round(HALF_MINUTE * log.rate))
    found = discover(Dynamics(arm), log, settings=A_FEW)
    assert found.verdict in set(DiscoveryVerdict)
    before, after = found.trace[0], found.trace[-1]
    assert (after.heldout_rms < before.heldout_rms + 0.03 * found.torque_rms).all()
    assert np.mean(after.heldout_rms / found.torque_rms) < 0.95 * np.mean(
        before.heldout_rms / found.torque_rms
    )
    assert all(t.effect.is_physical(np.array(t.theta), arm) for t in found.model.terms)
    again = load_model(save_model(found.model, tmp_path / "model.json"), arm)
    assert compare(again, log).rms == pytest.approx(compare(found.model, log).rms)


def test_ur10e_fitted_on_one_motion_predicts_another_five_times_better():
    arm, log = load("ur10e", "ur10e/fourier_50s.csv")
    _, other = load("ur10e", "ur10e/fourier_40s.csv")
    found = discover(Dynamics(arm), log, holdout=other)
    ratio = found.trace[-1].heldout_rms / found.trace[0].heldout_rms
    assert ratio.mean() <= 0.20


def test_a_bag_and_a_csv_of_the_same_run_agree():
    arm, csv = load("ur10", "ur10/exciting.csv")
    _, bag = load("ur10", "ur10/exciting.db3")
    assert compare(Dynamics(arm), bag).rms == pytest.approx(compare(Dynamics(arm), csv).rms, rel=1e-4)
