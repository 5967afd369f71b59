"""Drive gains that a log with torques does not need: a file that cannot be right is refused, a right one is said."""

import json

import pytest

ROBOT = ["--robot", "double_pendulum"]
READERS = {
    "check": ["check", "run.csv"],
    "compare": ["compare", "run.csv"],
    "compare logs": ["compare", "run.csv", "other.csv"],
    "discover": ["discover", "run.csv"],
    "add": ["add", "coulomb_friction@joint2", "run.csv"],
    "identify": ["identify", "run.csv"],
    "monitor": ["monitor", "other.csv", "--healthy", "run.csv"],
    "calibrate": ["calibrate", "run.csv", "other.csv", "--known-payload", "1"],
    "excite": ["excite", "--duration", "6", "--out", "motion.csv", "--after", "run.csv"],
    "convert": ["convert", "run.csv", "other.npz"],
}


@pytest.fixture
def folder(logs, tmp_path, monkeypatch):
    for name in ("run.csv", "other.csv"):
        (tmp_path / name).write_bytes((logs / name).read_bytes())
    texts = {
        "none.json": '{"a": 1.0, "b": 2.0}',
        "list.json": "[1.0, 2.0]",
        "model.json": '{"schema": "cdia-model/1", "terms": []}',
        "text.json": "joint1: 1.0",
        "right.json": json.dumps({"joint1": 1.0, "joint2": 2.0}),
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ("missing.json", "cannot read the drive gains missing.json: No such file"),
        (".", "it is a directory"),
        ("none.json", "no gain for joint1, joint2; it has 'a', 'b'"),
        ("list.json", "expected {joint: N·m/A}, found list"),
        ("model.json", "no gain for joint1, joint2; it has 'schema', 'terms'"),
        ("text.json", "not readable as JSON"),
    ],
)
@pytest.mark.parametrize("command", READERS)
def test_gains_that_cannot_be_right_are_refused_although_the_log_has_torques(
    cdia, folder, command, gains, said
):
    assert said in cdia(*READERS[command], *ROBOT, "--gains", gains).error


@pytest.mark.parametrize("command", READERS)
def test_gains_that_are_not_used_are_said(cdia, folder, command):
    ran = cdia(*READERS[command], *ROBOT, "--gains", "right.json")
    assert "drive gains not used: the log has efforts" in " ".join(ran.out.split()), ran


@pytest.mark.parametrize(
    "arguments",
    [["excite", "--out", "motion.csv"], ["view", "--simulate"]],
)
def test_gains_without_a_log_are_refused(cdia, folder, arguments):
    assert "log" in cdia(*arguments, *ROBOT, "--gains", "right.json").error.lower()
