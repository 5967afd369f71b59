"""No traceback reaches a terminal: what was foreseen is one line, and so is what was not."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROBOT = ("--robot", "double_pendulum")


class PanicException(BaseException):
    """What a panic of Rust becomes in Python: no Exception."""


@pytest.mark.parametrize(
    "error",
    [
        RuntimeError("odd\nthing"),
        ZeroDivisionError(),
        PanicException("index out of bounds"),
        RecursionError(),
    ],
)
def test_the_unexpected_is_one_line_and_a_file(cdia, monkeypatch, tmp_path, error):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def fail(*_, **__):
        raise error

    monkeypatch.setattr("cdia_pin.robot.load_robot", fail)
    done = cdia("robots", "ur5")
    assert done.code == 70
    (line,) = done.err.splitlines()
    assert line.startswith("cdia: error: ") and type(error).__name__ in line
    (file,) = tmp_path.glob("cdia-error-*.txt")
    assert str(file) in line
    text = file.read_text()
    assert "Traceback" in text and "cdia robots ur5" in text


def test_without_a_place_for_the_file_there_is_still_the_line(cdia, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", "/no/such/folder")
    monkeypatch.setattr("cdia_pin.robot.load_robot", lambda *_: 1 / 0)
    done = cdia("robots", "ur5")
    assert done.code == 70 and "cannot be written" in done.err and "Traceback" not in done.err


def started(*arguments: object, **options: object) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "cdia_pin", *map(str, arguments)]
    return subprocess.run(command, check=False, stderr=subprocess.PIPE, **options)


@pytest.mark.parametrize("closed", [(1,), (2,), (0, 1, 2)])
def test_closed_streams_do_no_harm(log, closed, tmp_path):
    out = tmp_path / "out.json"
    done = started("compare", log, *ROBOT, "--json", out, preexec_fn=lambda: [os.close(n) for n in closed])
    assert done.returncode == 0
    assert out.read_text().startswith("{") and out.read_text().endswith("}\n")


def test_output_in_ascii_loses_characters_and_nothing_else(log):
    for encoding in ("ascii", "latin-1"):
        done = started("check", log, *ROBOT, env={**os.environ, "PYTHONIOENCODING": encoding}, stdout=-1)
        assert done.returncode == 0 and b"Traceback" not in done.stderr


def changed(log: Path, file: Path, change) -> Path:
    names, *rows = log.read_text().splitlines()
    table = change(np.array([[float(cell) for cell in row.split(",")] for row in rows]), names.split(","))
    file.write_text("\n".join([names, *(",".join(f"{x:.17g}" for x in row) for row in table)]) + "\n")
    return file


def columns(signal: str, function):
    def change(table, names):
        for k, name in enumerate(names):
            if name.startswith(signal):
                table[:, k] = function(table[:, k])
        return table

    return change


def at_row_900(column: int, value: float):
    def change(table, names):
        table[900:, column] += value
        return table

    return change


ODD_LOGS = {
    "zeros": columns("", lambda x: x * 0 + (x if x[0] == 0 and x[-1] > 10 else 0)),
    "no effort": columns("effort", lambda x: x * 0),
    "constant effort": columns("effort", lambda x: x * 0 + 5),
    "no motion": columns("position", lambda x: x * 0),
    "huge positions": columns("position", lambda x: x * 1e300),
    "huge efforts": columns("effort", lambda x: x * 1e300),
    "tiny": columns("effort", lambda x: x * 1e-300),
    "huge times": columns("time", lambda x: x * 1e300),
    "tiny times": columns("time", lambda x: x * 1e-300),
    "times before time": columns("time", lambda x: x - 1e17),
    "a giant step": at_row_900(0, 1e12),
    "a larger step": at_row_900(0, 1e300),
    "a step of position": at_row_900(1, 1e6),
}


@pytest.mark.parametrize("kind", ODD_LOGS)
@pytest.mark.parametrize("command", ["check", "compare", "discover", "identify"])
def test_odd_logs_are_judged_or_refused(cdia, log, tmp_path, command, kind):
    file = changed(log, tmp_path / "odd.csv", ODD_LOGS[kind])
    done = cdia(command, file, *ROBOT, *(["--anyway"] if command == "discover" else []))
    assert done.code in {0, 2}, done.err
    assert "Traceback" not in done.err
    if done.code:
        assert done.error


BIG = "9" * 400


@pytest.mark.parametrize("number", [BIG, "9" * 5000, "[" * 50_000, "-1e400", "true", "null", '"x"', "{}"])
def test_odd_gains_are_refused(cdia, log, tmp_path, number):
    current = tmp_path / "current.csv"
    current.write_text(log.read_text().replace("effort", "current"))
    gains = tmp_path / "gains.json"
    gains.write_text(f'{{"joint1": {number}, "joint2": 1}}')
    assert cdia("check", current, *ROBOT, "--gains", gains).error


@pytest.mark.parametrize("place", ["value", "rate", "start"])
def test_a_number_of_400_digits_in_a_model_is_refused(cdia, log, tmp_path, place):
    model = tmp_path / "model.json"
    assert cdia("discover", log, *ROBOT, "--no-check", "--save", model).code == 0
    text, count = re.subn(rf'"{place}": [-0-9.e]+', f'"{place}": {BIG}', model.read_text(), count=1)
    assert count == 1
    model.write_text(text)
    assert cdia("compare", log, *ROBOT, "--no-check", "--model", model).error


def test_an_array_that_is_no_archive_and_names_that_are_no_text_are_refused(cdia, tmp_path):
    with (tmp_path / "bare.npz").open("wb") as file:
        np.save(file, np.zeros((10, 2)))
    assert "bare array" in cdia("check", tmp_path / "bare.npz", *ROBOT).error
    t, q = np.arange(1000) / 100, np.zeros((1000, 2))
    for names in (
        np.array([b"\xff", b"x"]),
        np.array([1, 2]),
        np.array([["a", "b"]]),
        np.array("a"),
        np.zeros(0),
    ):
        np.savez(tmp_path / "odd.npz", time=t, position=q, effort=q, joints=names)
        assert "names" in cdia("check", tmp_path / "odd.npz", *ROBOT).error
    np.savez(
        tmp_path / "bytes.npz", time=t, position=q, effort=q + 1.0, joints=np.array([b"joint1", b"joint2"])
    )
    assert cdia("check", tmp_path / "bytes.npz", *ROBOT).code == 0


@pytest.mark.parametrize("duration", ["1e308", "inf", "nan", "-1", "0", "1e-300", BIG])
def test_a_simulation_of_no_possible_duration_is_refused(cdia, tmp_path, duration):
    assert cdia("simulate", *ROBOT, "--duration", duration, "--out", tmp_path / "a.csv").error
