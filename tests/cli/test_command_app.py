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


def test_options_that_say_how_a_log_is_read_need_a_log_and_are_understood_before_anything_is_served(
    cdia, tmp_path: Path
):
    assert "how a log is read" in cdia("app", "--convert", "angle=deg").err
    log = tmp_path / "run.csv"
    log.write_text("time\n0\n")
    for option, value, said in (
        ("--convert", "angle=grad", "did you mean rad"),
        ("--joint-map", "x", "name=joint"),
        ("--columns", "x=q_#", "unknown signal"),
        ("--gains", str(tmp_path / "none.json"), "none.json"),
    ):
        outcome = cdia("app", str(log), "--robot", "ur5", "--no-open", option, value)
        assert (outcome.code, said in outcome.err) == (2, True)
