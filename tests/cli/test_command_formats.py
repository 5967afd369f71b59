"""Formats on the command line: options of every command that reads logs, and a dialogue on unknown columns."""

import inspect
import io
import sys

import pytest

from benchmarks.recordings import numbered, rtde, write
from cdia_pin import load_robot
from cdia_pin.cli import column_dialogue
from cdia_pin.cli.program import app
from tests.made_logs import with_velocity

READING = {"format", "columns", "episode"}


@pytest.fixture(scope="module")
def log():
    return with_velocity(load_robot("ur5"))


@pytest.fixture
def unknown(log, tmp_path):
    columns = {"zeit": log.time, **numbered("a", log.position), **numbered("c", log.effort)}
    return write(tmp_path / "unknown.csv", columns)


def test_every_command_that_takes_gains_takes_a_format():
    callbacks = [c.callback for c in app.registered_commands if c.callback is not None]
    reading = [f for f in callbacks if "gains" in inspect.signature(f).parameters]
    assert len(reading) > 8
    assert all(set(inspect.signature(f).parameters) >= READING for f in reading)


def test_a_recording_of_any_suffix_is_checked_with_its_format(cdia, log, tmp_path):
    path = write(tmp_path / "recording", rtde(log, actual_current_as_torque=log.effort))
    found = cdia("check", path, "--robot", "ur5", "--format", "rtde", "--json", "-").json["findings"]
    said = " ".join(f["message"] for f in found)
    assert "recording of a UR controller" in said
    assert "masses, centres of mass and payload cannot be judged" in said
    assert "drives the friction of the gear" in said


def test_a_pipe_is_told_what_to_type_and_never_asked(cdia, unknown):
    said = cdia("check", unknown, "--robot", "ur5").error
    option = "--columns 'time=zeit,position=a_#,effort=c_#'"
    assert said.endswith(option)
    assert cdia("check", unknown, "--robot", "ur5", *option.replace("'", "").split()).code == 0


def test_a_terminal_asks_and_says_what_to_type_next_time(cdia, unknown, monkeypatch):
    monkeypatch.setattr(column_dialogue, "can_ask", lambda: True)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n\n\n\n"))  # what stands in brackets
    done = cdia("check", unknown, "--robot", "ur5")
    assert done.code == 0
    assert "next time: --columns" in done.err
    assert "effort? (up to" in done.err
