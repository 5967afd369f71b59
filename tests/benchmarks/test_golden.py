"""The golden set: what it covers, what it compares, and that a run keeps what the command writes."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.golden import __main__ as golden
from benchmarks.golden import logs, run
from benchmarks.golden.compare import IGNORED, differences
from benchmarks.measured_logs.folder import BESIDE, VARIABLE, are_there
from benchmarks.plant.scenarios import OUTSIDE_PARAMETERS, PARAMETERS

CASES = run.read_cases()
COMMANDS = (
    "discover",
    "add",
    "compare",
    "convert",
    "identify",
    "excite",
    "check",
    "monitor",
    "simulate",
    "export",
    "study",
)

SIMULATE = "simulate --robot double_pendulum --duration 3 --out run.csv"


def answers(value: object, exit_code: int = 0, log: str = "abc") -> dict:
    files = {"1_discover.json": {"rms": {"joint1": value}, "version": str(value), "verdict": "explained"}}
    return {
        "logs": {"a.npz": log},
        "cases": {"one": {"exit": [exit_code], "files": files, "processor_s": value}},
    }


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        (1.0, 1.0 + 5e-10, True),
        (1.0, 1.0 + 5e-9, False),
        (1e6, 1e6 * (1 + 5e-10), True),
        (1e6, 1e6 * (1 + 5e-9), False),
        (0.0, 5e-10, True),
        (0, 0.0, True),
        (float("nan"), float("nan"), True),
        (float("nan"), 0.0, False),
        (None, 0.0, False),
        (True, 1, False),
        ("unique", "unknown", False),
        ([1.0], [1.0, 2.0], False),
        ({"joint1": 1.0}, {"joint2": 1.0}, False),
    ],
)
def test_numbers_are_the_same_to_a_tolerance_and_words_exactly(a: object, b: object, same: bool) -> None:
    assert bool(differences(answers(a), answers(b))) is not same


def test_what_is_ignored_is_ignored_wherever_it_stands() -> None:
    a, b = ({"deep": [dict.fromkeys(IGNORED, text)]} for text in ("one", "other"))
    assert not differences(answers(a), answers(b))
    assert differences(answers({"sentences": "one"}), answers({"sentences": "other"}))


def test_an_exit_code_or_a_missing_case_differs() -> None:
    assert differences(answers(1.0), answers(1.0, exit_code=1))
    assert differences(answers(1.0), answers(1.0) | {"cases": {}}) == {"one": ["only in the first"]}


def test_answers_of_other_logs_are_not_compared() -> None:
    with pytest.raises(ValueError, match=r"of other logs: a\.npz"):
        differences(answers(1.0), answers(1.0, log="abd"))


def test_the_exit_code_says_whether_anything_differs(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    files = [tmp_path / name for name in ("a.json", "b.json")]
    for file, value in zip(files, (1.0, 2.0), strict=True):
        file.write_text(json.dumps(answers(value)))
    assert golden.main(["--compare", *map(str, files)]) == 1
    assert "one: 1 differences\n  /files/1_discover.json/rms/joint1: 1.0 → 2.0" in capsys.readouterr().out
    assert golden.main(["--compare", str(files[0]), str(files[0])]) == 0


def test_the_set_covers_every_command_and_every_effect() -> None:
    seeded = [c for c in CASES if not any("{data}" in line for line in c.lines)]
    assert len(seeded) >= 60
    assert {line.split()[0] for c in CASES for line in c.lines} >= set(COMMANDS)
    plans = (*logs.SINGLES, *logs.SEVERAL, *logs.OUTSIDE)
    assert {effect for plan in plans for effect in plan[2]} >= {*PARAMETERS, *OUTSIDE_PARAMETERS}


def test_every_seeded_log_is_read_and_every_log_that_is_read_is_made() -> None:
    read = {name for c in CASES for line in c.lines for name in re.findall(r"\{logs\}/(\w+)\.npz", line)}
    assert read == {name for name, _ in logs.logs()}


def test_every_measured_log_is_read() -> None:
    data = Path(os.environ.get(VARIABLE, BESIDE))
    if not are_there(data):
        pytest.skip("the measured logs are absent")
    read = {
        name for c in CASES for line in c.lines for name in re.findall(r"\{data\}/(\S+\.(?:csv|db3))", line)
    }
    there = {str(f.relative_to(data)) for f in data.rglob("*.*") if f.suffix in {".csv", ".db3"}}
    assert there - read == {"ur5/pushed_at_rest_wrench.csv"}  # a force at the tool, no log of joints


def test_a_run_keeps_what_the_command_writes_and_of_a_failure_the_exit_code_alone(tmp_path: Path) -> None:
    (tmp_path / "cases.toml").write_text(
        'quick = ["simulated"]\n[some]\n'
        f'"simulated" = ["{SIMULATE}", "compare run.csv --robot double_pendulum"]\n'
        f'"refused" = ["{SIMULATE}", "compare none.csv --robot ur5"]\n'
        '"left out" = "check {logs}/none.npz --robot ur5"\n'
        "[measured_logs]\n",
        encoding="utf-8",
    )
    out = tmp_path / "answers.json"
    folders = ["--cases", tmp_path / "cases.toml", "--logs", tmp_path, "--data", tmp_path / "data"]
    environment = os.environ | {"PYTHONPATH": str(golden.CHECKOUT)}
    subprocess.run([sys.executable, run.__file__, out, *folders, "--jobs", "2"], check=True, env=environment)
    kept = json.loads(out.read_text())["cases"]
    assert kept["left out"] == {"skipped": True}
    assert (kept["refused"]["exit"], kept["refused"]["files"]) == ([0, 2], {})
    assert kept["simulated"]["exit"] == [0, 0]
    files = kept["simulated"]["files"]
    assert set(files) == {"1_simulate.json", "2_compare.json", "run.csv"}
    assert files["run.csv"]["position.joint1"]["count"] == 751
    assert files["2_compare.json"]["schema"] == "cdia-comparison/1"


def test_the_numbers_of_a_urdf_are_those_that_a_correction_writes(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="arm"><link name="one"><inertial><origin xyz="1 2 3" rpy="0 0 0"/><mass value="4"/>'
        '<inertia ixx="5" ixy="0" ixz="0" iyy="6" iyz="0" izz="7"/></inertial></link>'
        '<joint name="j" type="revolute"><dynamics damping="0.5" friction="0.25"/></joint></robot>'
    )
    assert run.urdf_numbers(file) == {
        "link one": [4, 0, 0, 0, 1, 2, 3, 5, 0, 0, 6, 0, 7],
        "joint j": [0.5, 0.25],
    }
