"""The benchmark on logs of any arm: a command with an arm and its logs, and a page of the same tables."""

import sys

import pytest

from benchmarks.real_residuals import other_arms, own_logs
from benchmarks.real_residuals.recordings import ARMS, MeasuredArm
from cdia_pin import load_robot
from cdia_pin.logs import write_log
from tests.made_logs import make

ROBOT = load_robot("kinova")


def run(monkeypatch, *words):
    monkeypatch.setitem(ARMS, ROBOT.name, MeasuredArm(ROBOT.name, "kinova"))  # forgotten again after the test
    monkeypatch.setattr(sys, "argv", ["own_logs", "kinova", *map(str, words)])
    own_logs.main()


def test_two_logs_give_a_page_of_what_is_named(tmp_path, monkeypatch):
    for name, seed in (("one", 3), ("two", 4)):
        write_log(make(ROBOT, seed=seed).log, tmp_path / f"{name}.csv")
    page = tmp_path / "page.md"
    run(
        monkeypatch,
        tmp_path / "one.csv",
        tmp_path / "two.csv",
        "--sizes",
        "25",
        "--limit",
        "4",
        "--out",
        page,
    )
    text = page.read_text()
    assert text.startswith(f"# Known effects on real residuals of {ROBOT.name}\n")
    assert "own_logs kinova one.csv two.csv --sizes 25 --limit 4`" in text
    assert str(tmp_path) not in text
    assert "exactly the effect is named" in text


def test_a_log_that_is_not_there_is_said(tmp_path, monkeypatch, capsys):
    with pytest.raises(SystemExit, match="2"):
        run(monkeypatch, tmp_path / "none.csv")
    assert "not a CSV file" in capsys.readouterr().err


def test_a_log_that_cannot_be_read_is_said(tmp_path, monkeypatch, capsys):
    log = tmp_path / "other.csv"
    log.write_text("time,temperature\n0,20\n1,21\n")
    with pytest.raises(SystemExit, match="2"):
        run(monkeypatch, log)
    assert "position" in capsys.readouterr().err


def test_pages_of_single_arms_become_one_table(tmp_path, monkeypatch):
    line = "| `compare A B`, effects of 25 %: exactly the effect is named | ≥ 85% | 75 % (3/4) | 4 | no |"
    for arm in ("one", "two"):
        (tmp_path / f"results-other-arm-{arm}.md").write_text(f"# Known\n\n{line}\n", encoding="utf-8")
    page = tmp_path / "table.md"
    monkeypatch.setattr(sys, "argv", ["other_arms", "--docs", str(tmp_path), "--out", str(page)])
    other_arms.main()
    rows = page.read_text(encoding="utf-8").splitlines()
    assert "| [one](results-other-arm-one.md) | 3 of 4 | – | – | – | – | – |" in rows
    assert "| all 2 | 6 of 8 | – | – | – | – | – |" in rows


def test_a_folder_without_pages_is_an_error(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["other_arms", "--docs", str(tmp_path)])
    with pytest.raises(SystemExit):
        other_arms.main()
    assert "no page results-other-arm-*.md" in capsys.readouterr().err
