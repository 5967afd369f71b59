"""The study of accommodation on several arms, on a small one and for a short time."""

import json

import numpy as np
import pytest

from cdia_pin.campaigns import arm_study
from cdia_pin.campaigns.arm_study import FIRST, SETTLED, arm_faults, to_dict
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.dynamics import Dynamics
from cdia_pin.robot import load_robot
from cdia_pin.viewers.arm_figures import arm_pictures
from cdia_pin.viewers.arm_report import arm_rows, write_arm_report

LOSS = "30 % torque loss"


@pytest.fixture(scope="module")
def found():
    settings = LoopSettings(rate=250.0, healthy_runs=1, healthy_duration=8.0)
    return arm_study.arm_study(["double_pendulum"], settings=settings, duration=8.0, cases=[LOSS])


def test_a_torque_loss_on_all_joints_is_named_and_compensated(found):
    (case,) = found
    rms = case.tracking()
    assert case.compared.since == FIRST + SETTLED
    assert case.named() == (2, 2)
    assert case.wrong() == ()
    assert (rms["accommodated"] < 0.2 * rms["faulty"]).all()


def test_faults_are_in_proportion_to_the_torques_of_their_joints():
    loop = ClosedLoop(Dynamics(load_robot("ur5")))
    faults = arm_faults(loop, 12.0)
    assert list(faults) == [LOSS, "Coulomb friction", "friction, then torque loss"]
    levels = np.array([t.theta[0] for t in faults["Coulomb friction"]])
    assert levels[1] > 10 * levels[5]
    assert len(faults["friction, then torque loss"]) == 3 * 6


def test_the_document_is_plain_json(found):
    document = to_dict([case.to_dict() for case in found])
    assert document["schema"] == "cdia-study-arms/1"
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert document["cases"][0]["named"] == 2


def test_the_report_shows_every_case(found, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("cdia_pin.viewers.study_figures.DPI", 30)
    pictures = list(arm_pictures(found))
    assert [p.name for p in pictures] == ["double_pendulum_30_torque_loss"]
    assert pictures[0].png.startswith(b"\x89PNG")
    settings = found[0].compared.loop.settings
    report = tmp_path / "new" / "arms.html"
    page = write_arm_report(report, arm_rows(found), settings, pictures, "cdia study arms").read_text("utf-8")
    assert page.count("data:image/png") == 1
    assert arm_rows(found)[0][-1] == "2 of 2"
    assert "2 of 2" in page
