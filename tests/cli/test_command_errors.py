"""Bad input ends in one line on stderr and exit code 2, before time is spent."""

import json
import subprocess
import sys

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.logs.log_writer import columns_of

ROBOT = ("--robot", "double_pendulum")


@pytest.fixture(scope="session")
def broken(logs, log, tmp_path_factory):
    """Folder of files that cannot be used."""
    folder = tmp_path_factory.mktemp("broken")
    rows = log.read_text().splitlines()
    header, body = rows[0].split(","), rows[1:]

    def write(name, names, lines):
        (folder / name).write_text("\n".join([",".join(names), *lines]) + "\n")

    write("no_effort.csv", header[:3], [",".join(r.split(",")[:3]) for r in body])
    write("other_joint.csv", [h.replace("joint2", "wrist") for h in header], body)
    write("current.csv", [h.replace("effort", "current") for h in header], body)
    write("short.csv", header, body[:150])
    hole = ",".join([body[700].split(",")[0], *["nan"] * (len(header) - 1)])
    write("nan.csv", header, [*body[:700], hole, *body[701:]])
    (folder / "garbage.csv").write_bytes(bytes(range(256)) * 20)
    (folder / "prose.csv").write_text("It was a dark and stormy night;\nthe rain fell in torrents\n" * 30)
    (folder / "empty.csv").write_text("")
    (folder / "notes.docx").write_text("run 7")
    (folder / "model.json").write_text("{")
    (folder / "robot.urdf").write_text("<robot")
    (folder / "gains.json").write_text(json.dumps({"joint1": 1.0}))
    return folder


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("no_effort.csv", "no effort columns"),
        ("other_joint.csv", "joint2"),
        ("current.csv", "--gains"),
        ("short.csv", "too short"),
        ("nan.csv", "not finite"),
        ("garbage.csv", "garbage.csv"),
        ("prose.csv", "prose.csv"),
        ("empty.csv", "empty"),
        ("notes.docx", "unknown log format"),
        ("missing.csv", "no such file"),
    ],
)
@pytest.mark.parametrize("command", ["compare", "discover"])
def test_unusable_logs(cdia, broken, command, name, said):
    assert said in cdia(command, broken / name, *ROBOT).error


def test_a_log_that_is_not_of_the_robot(cdia, log):
    assert "shoulder_pan_joint" in cdia("compare", log, "--robot", "ur5").error


def test_gains_that_lack_a_joint(cdia, broken):
    said = cdia("compare", broken / "current.csv", *ROBOT, "--gains", broken / "gains.json").error
    assert "no gain for joint2" in said


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--robot", "double_pendulm"], "did you mean double_pendulum"),
        (["--robot", "missing.urdf"], "missing.urdf"),
        ([*ROBOT, "--joint-map", "joint1=elbow"], "unknown joint 'elbow'"),
        ([*ROBOT, "--convert", "angle=degrees"], "did you mean deg"),
        ([*ROBOT, "--cutoff", "-1"], "'--cutoff': must be 0.001 to 100000 Hz, given -1"),
        ([*ROBOT, "--cutoff", "fast"], "--cutoff"),
        ([*ROBOT, "--modle", "m.json"], "--model"),
        ([*ROBOT, "--model", "missing.json"], "missing.json"),
        ([], "--robot"),
    ],
)
def test_bad_options(cdia, log, arguments, said):
    assert said in cdia("compare", log, *arguments).error


def test_files_of_the_wrong_kind(cdia, log, broken):
    assert "not a model" in cdia("compare", log, *ROBOT, "--model", broken / "model.json").error
    assert "robot.urdf" in cdia("compare", log, "--robot", broken / "robot.urdf").error


def test_unknown_names_give_the_nearest(cdia, log):
    assert "did you mean compare" in cdia("comapre", log).error
    assert "did you mean coulomb_friction" in cdia("effects", "columb_friction").error
    assert (
        "did you mean coulomb_friction" in cdia("discover", log, *ROBOT, "--effects", "columb_friction").error
    )
    assert "did you mean joint2" in cdia("add", "coulomb_friction@jiont2", log, *ROBOT).error
    assert "did you mean ur5" in cdia("robots", "ur55").error


def test_effects_that_cannot_be_added(cdia, log):
    assert "coulomb_friction@JOINT" in cdia("add", "coulomb_friction", log, *ROBOT).error
    assert "not arithmetic" in cdia("discover", log, *ROBOT, "--extra", "q.real").error
    assert "did you mean joint1" in cdia("discover", log, *ROBOT, "--extra", "sin(q)@jiont1").error
    assert "effect comes before" in cdia("add", log, log, *ROBOT).error
    assert "names none" in cdia("discover", log, *ROBOT, "--effects", ",").error


@pytest.mark.parametrize("option", ["--save", "--report", "--json"])
def test_what_cannot_be_written_is_said_before_the_log_is_read(cdia, tmp_path, option):
    unread = tmp_path / "not_there.csv"
    assert "no directory" in cdia("discover", unread, *ROBOT, option, tmp_path / "nowhere" / "file").error
    assert "is a directory" in cdia("discover", unread, *ROBOT, option, tmp_path).error


def test_looking_whether_a_file_can_be_written_leaves_no_trace(cdia, broken, tmp_path):
    there, new = tmp_path / "there.json", tmp_path / "new.json"
    there.write_text("kept")
    for file in (there, new):
        assert cdia("compare", broken / "nan.csv", *ROBOT, "--json", file).code == 2
    assert there.read_text() == "kept"
    assert not new.exists()


def test_inputs_are_not_overwritten(cdia, log):
    before = log.read_bytes()
    assert "overwritten" in cdia("compare", log, *ROBOT, "--json", log).error
    assert "overwritten" in cdia("convert", log, log, *ROBOT).error
    assert log.read_bytes() == before


def test_one_file_is_not_written_twice(cdia, log, tmp_path):
    file = tmp_path / "out.json"
    assert "two outputs" in cdia("discover", log, *ROBOT, "--save", file, "--json", file).error


def test_a_fitted_log_is_not_held_out(cdia, log):
    assert "--holdout" in cdia("discover", log, *ROBOT, "--holdout", log).error


def test_an_interrupt_is_not_a_crash(cdia, log, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("cdia_pin.discovery.compare_in", interrupted)
    outcome = cdia("compare", log, *ROBOT)
    assert outcome.code == 130
    assert "Traceback" not in outcome.err


def test_what_memory_cannot_hold_is_one_line(cdia, log, monkeypatch):
    def too_large(*_, **__):
        raise MemoryError("Unable to allocate 3.64 TiB")

    monkeypatch.setattr("cdia_pin.discovery.compare_in", too_large)
    assert "Unable to allocate" in cdia("compare", log, *ROBOT).error


def test_a_suspicious_log_is_warned_of_in_one_line(cdia, log, tmp_path):
    from cdia_pin import read_log

    good = read_log(log, load_robot("double_pendulum"))
    columns = columns_of(good)
    columns["effort.joint1"] = -columns["effort.joint1"]
    flipped = tmp_path / "flipped.csv"
    table = np.column_stack(list(columns.values()))
    np.savetxt(flipped, table, delimiter=",", header=",".join(columns), comments="")

    outcome = cdia("compare", flipped, *ROBOT)
    assert outcome.code == 0
    (warning,) = outcome.err.splitlines()
    assert warning.startswith("cdia: warning: flipped.csv: joint1: ")
    assert f"cdia check {flipped}" in warning
    assert cdia("compare", flipped, *ROBOT, "--no-check").err == ""


@pytest.mark.parametrize("arguments", [["robots"], ["compare", "LOG", *ROBOT, "--json", "JSON"], ["--help"]])
def test_a_closed_pipe_is_not_a_crash(log, tmp_path, arguments):
    file = tmp_path / "out.json"
    given = [{"LOG": str(log), "JSON": str(file)}.get(a, a) for a in arguments]
    process = subprocess.Popen(
        [sys.executable, "-m", "cdia_pin", *given], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.close()  # as `| head` does, but before the first line
    said = process.stderr.read()
    process.wait()
    assert said == ""
    if "JSON" in arguments:
        assert process.returncode == 0
        assert json.loads(file.read_text())["schema"] == "cdia-comparison/1"
