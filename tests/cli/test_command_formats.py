"""Formats on the command line: options of every command that reads logs, and a dialogue on unknown columns."""

import contextlib
import inspect
import io
import os
import pty
import shlex
import subprocess
import sys
import threading
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.recordings import numbered, rtde, write
from cdia_pin import load_robot, write_log
from cdia_pin.cli import column_dialogue
from cdia_pin.cli.program import app
from tests.made_logs import with_velocity

READING = {"format", "columns", "episode"}


@pytest.fixture(scope="module")
def log():
    return with_velocity(load_robot("ur5"))


def of_unknown_names(path, log, angle="a"):
    columns = {"zeit": log.time, **numbered(angle, log.position), **numbered("c", log.effort)}
    return write(path, columns)


@pytest.fixture
def unknown(log, tmp_path):
    return of_unknown_names(tmp_path / "unknown.csv", log)


@pytest.fixture
def answering(monkeypatch):
    """A terminal at which each question is answered with what stands in brackets."""

    def sit_down(questions):
        monkeypatch.setattr(column_dialogue, "can_ask", lambda: True)
        monkeypatch.setattr(sys, "stdin", io.StringIO("\n" * questions))

    return sit_down


def next_words(done):
    assert done.code == 0, done.err
    return shlex.split(done.out.rpartition("next: cdia ")[2])


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


def test_a_terminal_asks_and_says_what_to_type_next_time(cdia, unknown, answering):
    answering(4)
    done = cdia("check", unknown, "--robot", "ur5")
    assert done.code == 0
    assert "next time: --columns" in done.err
    assert "effort? (up to" in done.err


COLUMNS = ["--columns", "time=zeit,position=a_#,effort=c_#"]


@pytest.mark.parametrize(
    "command", ["compare", "monitor"]
)  # the next one is another, and the same with an option
def test_the_next_command_says_what_was_answered(cdia, log, tmp_path, answering, command):
    degrees = of_unknown_names(tmp_path / "plc.csv", replace(log, position=np.degrees(log.position)))
    answering(4)
    line = next_words(cdia(command, degrees, "--robot", "ur5"))
    assert " ".join([*COLUMNS]) in " ".join(line) and "--convert angle=deg" in " ".join(line)


def test_logs_with_the_same_columns_are_asked_about_once(cdia, unknown, log, tmp_path, answering):
    other = of_unknown_names(tmp_path / "other.csv", log)
    answering(4)
    done = cdia("compare", unknown, other, "--no-changes", "--robot", "ur5")
    assert done.err.count("next time:") == 1
    assert COLUMNS[1] in next_words(done)


@pytest.mark.parametrize("own", [False, True])
def test_what_holds_for_one_of_two_logs_only_is_not_said_of_both(
    cdia, unknown, log, tmp_path, answering, own
):
    other = tmp_path / "other.csv"
    if own:
        of_unknown_names(other, log, angle="b")
    else:
        write_log(log, other)
    answering(8)
    assert "--columns" not in next_words(cdia("compare", unknown, other, "--no-changes", "--robot", "ur5"))


def read_on(file):
    """Read what a terminal shows until it is closed, so that whoever writes there never waits."""
    with contextlib.suppress(OSError):
        while os.read(file, 4096):
            pass


def test_what_is_answered_in_a_terminal_is_in_a_next_command_that_a_pipe_can_run(cdia, log, tmp_path):
    degrees = of_unknown_names(tmp_path / "plc.csv", replace(log, position=np.degrees(log.position)))
    person, terminal = pty.openpty()
    command = [sys.executable, "-m", "cdia_pin", "check", str(degrees), "--robot", "ur5"]
    with subprocess.Popen(
        command, stdin=terminal, stderr=terminal, stdout=subprocess.PIPE, text=True
    ) as program:
        threading.Thread(target=read_on, args=[person], daemon=True).start()
        os.write(person, b"\n" * 4)  # what stands in brackets
        said, _ = program.communicate(timeout=120)
    os.close(terminal)
    line = shlex.split(said.rpartition("next: cdia ")[2])
    assert COLUMNS[1] in line
    assert cdia(*line).code == 0
