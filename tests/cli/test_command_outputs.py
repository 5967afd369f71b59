"""Every output of a command is whole or the old one: on a full disk, beyond a limit, through a symlink."""

import resource
import subprocess
import sys

import pytest

LIMIT = 500  # bytes a file may have; every output below is larger

OUTPUTS = {
    "convert.csv": ["convert", "LOG", "FILE", "--robot", "double_pendulum"],
    "convert.parquet": ["convert", "LOG", "FILE", "--robot", "double_pendulum"],
    "convert.npz": ["convert", "LOG", "FILE", "--robot", "double_pendulum"],
    "simulate.csv": ["simulate", "--robot", "double_pendulum", "--duration", "5", "--out", "FILE"],
    "compare.json": ["compare", "LOG", "--robot", "double_pendulum", "--no-check", "--json", "FILE"],
    "compare.html": ["compare", "LOG", "--robot", "double_pendulum", "--no-check", "--report", "FILE"],
    "save.json": [
        "add",
        "viscous_friction@joint1",
        "LOG",
        "--robot",
        "double_pendulum",
        "--no-check",
        "--save",
        "FILE",
    ],
}


@pytest.mark.parametrize("name", OUTPUTS)
def test_a_limit_on_the_size_of_files_leaves_the_old_one(name, log, tmp_path):
    file = tmp_path / name
    file.write_text("old")
    arguments = [{"LOG": str(log), "FILE": str(file)}.get(a, a) for a in OUTPUTS[name]]
    done = subprocess.run(
        [sys.executable, "-m", "cdia_pin", *arguments],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT)),
    )
    assert done.returncode == 2, (done.stdout, done.stderr)
    *_, last = done.stderr.splitlines()
    assert last.startswith("cdia: error: ") and "File too large" in last
    assert file.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_a_folder_that_cannot_be_written_is_said_before_the_work(cdia, log, tmp_path):
    missing = cdia("convert", log, tmp_path / "none" / "out.csv", "--robot", "double_pendulum")
    assert "there is no directory" in missing.error


@pytest.mark.parametrize("option", ["--json", "--report"])
def test_an_option_without_its_value_does_not_replace_the_log_that_follows(option, cdia, log, tmp_path):
    first = tmp_path / "first.csv"
    first.write_bytes(log.read_bytes())
    done = cdia("compare", option, first, log, "--robot", "double_pendulum", "--no-check")
    assert "first.csv would be overwritten, but it is a log" in done.error
    assert first.read_bytes() == log.read_bytes()


def test_an_earlier_result_is_replaced_whatever_its_name(cdia, log, tmp_path):
    file = tmp_path / "result.txt"
    for _ in range(2):
        done = cdia("compare", log, "--robot", "double_pendulum", "--no-check", "--json", file)
        assert done.code == 0, done.err
    assert file.read_text().startswith("{")
