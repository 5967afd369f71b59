"""``cdia app`` refuses what it cannot show before it serves anything."""

from pathlib import Path


def test_a_log_needs_its_robot(cdia):
    outcome = cdia("app", "run.csv")
    assert outcome.code == 2
    assert "a log needs its robot" in outcome.err
    assert cdia("app", "--robot", "ur5").code == 2


def test_a_log_must_be_there(cdia, tmp_path: Path):
    outcome = cdia("app", str(tmp_path / "none.csv"), "--robot", "ur5")
    assert outcome.code == 2
    assert "there is no log" in outcome.err


def test_its_robot_must_be_known(cdia, tmp_path: Path):
    (tmp_path / "run.csv").write_text("time\n0\n")
    outcome = cdia("app", str(tmp_path / "run.csv"), "--robot", "ur55", "--no-open")
    assert outcome.code == 2
    assert "ur5" in outcome.err
