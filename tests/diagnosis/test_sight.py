"""What a monitor can see: thresholds beside torques."""

import json

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis.sight import BLIND_SHARE, Sight, blind_advice, blind_joints

JOINTS = ("a", "b", "c", "d")
SIGHT = Sight(JOINTS, np.array([0.1, 0.4, 0.1, 0.1]), np.array([1.0, 1.0, 0.0, np.nan]))


def test_a_joint_is_blind_above_the_share_and_where_it_needs_no_torque():
    assert SIGHT.blind == ("b", "c")
    edge = Sight(("a",), np.array([BLIND_SHARE]), np.ones(1))
    assert edge.blind == ()


def test_a_torque_that_is_not_known_makes_no_joint_blind():
    assert "d" not in SIGHT.blind
    assert SIGHT.to_dict()["d"] == {"threshold": 0.1, "torque_rms": None, "share": None, "blind": False}


def test_the_document_is_plain_json_and_holds_what_is_shown():
    document = json.loads(json.dumps(SIGHT.to_dict(), allow_nan=False))
    assert document["b"] == {"threshold": 0.4, "torque_rms": 1.0, "share": 0.4, "blind": True}
    assert document["c"]["share"] is None
    assert blind_joints(document) == ["b", "c"]


def test_the_advice_names_the_joints_and_what_to_do():
    assert blind_advice((), False) == ""
    bare = blind_advice(SIGHT.blind, model_has_terms=False)
    assert bare.startswith("blind on b, c: a fault of 30%")
    assert "cdia discover" in bare
    richer = blind_advice(SIGHT.blind, model_has_terms=True)
    assert "cdia discover" not in richer
    assert "more healthy motion" in richer


def test_a_monitor_with_given_thresholds_says_nothing_of_torques():
    threshold = {"joint1": 1.0, "joint2": 2.0}
    monitor = Monitor(Dynamics(load_robot("double_pendulum")), threshold=threshold, rate=1000.0)
    assert monitor.record["sight"]["joint2"]["threshold"] == pytest.approx(2.0)
    assert blind_joints(monitor.record["sight"]) == []
    assert monitor.update(0.0, np.zeros(2), np.zeros(2), np.zeros(2)).blind == ()
