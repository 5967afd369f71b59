"""What is typed becomes a request and comes back; what cannot be used is told before anything is served."""

import socket
from pathlib import Path

import pytest

from cdia_pin import CdiaError
from cdia_pin.app.form import Form
from cdia_pin.app.inputs import Request
from cdia_pin.app.page_files import SERVED, served
from cdia_pin.app.server import HOST, free_port

ASKED = Request(
    "ur5",
    Path("/logs/run.csv"),
    joint_map={"third": "elbow_joint"},
    convert={
        "angle": "deg",
        "flip_effort": ("elbow_joint",),
        "reduction": {"elbow_joint": 101.0},
        "gravity": "compensated",
        "rate": 166.66666666666666,
    },
    gains={"elbow_joint": 10.5, "wrist_1_joint": {"value": 9.0, "tolerance": 0.5}},
    format="csv",
    columns={"position": "J# ang", "effort": "J# mom"},
    episode=2,
)


def test_a_request_goes_through_the_form_unchanged():
    form = Form()
    form.take(ASKED)
    assert form.request() == ASKED
    assert not form.plain
    form.take(Request("ur5", Path("/logs/run.csv")))
    assert form.plain


def test_what_is_typed_is_what_is_asked_for():
    form = Form(robot=" ur5 ", log="/logs/run.csv")
    form.units["torque"] = "Nmm"
    form.note("elbow_joint", "gain", "12.5")
    form.note("elbow_joint", "label", "")
    form.note("wrist_1_joint", "flip_position", True)
    asked = form.request()
    assert (asked.robot, asked.gains, asked.joint_map) == ("ur5", {"elbow_joint": 12.5}, {})
    assert asked.convert == {"torque": "Nmm", "flip_position": ("wrist_1_joint",)}
    form.note("elbow_joint", "gain", "many")
    with pytest.raises(CdiaError, match="drive gain of elbow_joint must be a number, given 'many'"):
        form.request()


def test_a_dropped_file_is_shown_by_its_name():
    form = Form()
    form.robot, form.log = form.dropped_as(Path("/tmp/x/arm.urdf")), form.dropped_as(Path("/tmp/x/run.csv"))
    asked = form.request()
    assert (form.robot, form.log) == ("arm.urdf", "run.csv")
    assert (asked.robot, asked.log) == ("/tmp/x/arm.urdf", Path("/tmp/x/run.csv"))
    assert (asked.robot_name, asked.name) == ("arm.urdf", "run.csv")
    form.take(asked)
    assert form.request() == asked


def test_what_is_wrong_stays_with_its_field():
    form = Form(robot="ur5", log="/logs/run.csv")
    form.note("elbow_joint", "gain", "10,5")
    form.note("wrist_1_joint", "gain", "9 ± many")
    form.episode, form.rate = "first", "fast"
    assert set(form.faults()) == {"gain-elbow_joint", "gain-wrist_1_joint", "episode", "rate"}
    assert form.joints["elbow_joint"]["gain"] == "10,5"


def test_advice_is_added_to_what_was_asked_for():
    more = (
        ASKED.converted("flip_effort=wrist_1_joint").converted("torque=Nmm").converted("use_velocity=false")
    )
    assert more.convert["flip_effort"] == ("elbow_joint", "wrist_1_joint")
    assert (more.convert["angle"], more.convert["torque"], more.convert["use_velocity"]) == (
        "deg",
        "Nmm",
        False,
    )
    assert ASKED.convert["flip_effort"] == ("elbow_joint",)
    with pytest.raises(CdiaError, match="key"):
        ASKED.converted("colour=red")


def test_a_port_in_use_is_reported():
    with socket.socket() as taken:
        taken.bind((HOST, 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(CdiaError, match=f"port {port} of 127.0.0.1 cannot be used"):
            free_port(port)
    assert free_port(None) > 0
    with pytest.raises(CdiaError, match="70000"):
        free_port(70000)


@pytest.mark.parametrize("name", SERVED)
def test_what_is_served_is_there_and_asks_nothing_of_the_network(name):
    kind, text = served(name)
    assert kind in {"text/javascript", "text/css"}
    assert len(text) > 100
    assert "@import" not in text
