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
