"""A map says which robot has which model and logs; what is wrong in it is said in one line."""

import pytest

from cdia_pin.fleet import FleetError, FleetMap

GOOD = '[robots.a]\nrobot = "ur5"\nlogs = ["a/*.csv"]\n'


def written(folder, text):
    path = folder / "fleet.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "expected a table"),
        ("[robots", "is not a map of robots"),
        ('[robots.a]\nlogs = ["x"]\n', "states no robot"),
        ('[robots.a]\nrobot = "ur5"\n', "states no logs"),
        (GOOD + 'modell = "m.json"\n', "did you mean model"),
        (GOOD + 'model = "m.json"\n', "there is no model"),
        (GOOD + 'job = ["paylod"]\n', "did you mean payload"),
        (GOOD + 'searched = ["stribeck_friction"]\n', "has a shape"),
        (GOOD + "cutoff = -1\n", "above 0"),
        (GOOD + '[robots.a.recorded]\n"x.csv" = "May"\n', "must be a date"),
        ('[robots."../a"]\nrobot = "ur5"\nlogs = ["x"]\n', "a name has letters"),
        (GOOD + "[others]\n", "unknown table"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path, text, said):
    with pytest.raises(FleetError, match=said) as caught:
        FleetMap.read(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_a_log_has_one_robot(tmp_path):
    (tmp_path / "a").mkdir()
    log = tmp_path / "a" / "1.csv"
    log.touch()
    fleet = FleetMap.read(written(tmp_path, GOOD))
    assert fleet.logs == (log.resolve(),)
    assert fleet.robot_of(log).name == "a"
    with pytest.raises(FleetError, match="of no robot"):
        fleet.robot_of(tmp_path / "b.csv")
    twice = GOOD + GOOD.replace("robots.a", "robots.b")
    with pytest.raises(FleetError, match="several robots"):
        FleetMap.read(written(tmp_path, twice)).robot_of(log)


def test_the_map_may_state_when_a_log_was_recorded(tmp_path):
    text = GOOD + '[robots.a.recorded]\n"run_*.csv" = 2026-05-12\n"x.csv" = 2026-05-13T08:00:00\n'
    (robot,) = FleetMap.read(written(tmp_path, text)).robots
    assert robot.stated_time(tmp_path / "run_7.csv").day == 12
    assert robot.stated_time(tmp_path / "x.csv").hour == 8
    assert robot.stated_time(tmp_path / "y.csv") is None


@pytest.mark.parametrize(
    ("logs", "folders"),
    [
        ('["backup-2025-01-01/*/run.csv"]', ("2026-05-12",)),
        ('["backup-2025-01-01/2026-05-12/run.csv", "backup-2025-01-01/2026-05-13/run.csv"]', ("2026-05-12",)),
        ('["backup-2025-01-01/2026-05-12/*.csv"]', ()),
        ('["**/run.csv"]', ("backup-2025-01-01", "2026-05-12")),
    ],
)
def test_only_folders_in_which_logs_differ_say_something_of_one(tmp_path, logs, folders):
    log = tmp_path / "backup-2025-01-01" / "2026-05-12" / "run.csv"
    log.parent.mkdir(parents=True)
    log.touch()
    text = GOOD.replace('["a/*.csv"]', logs)
    (robot,) = FleetMap.read(written(tmp_path, text)).robots
    assert robot.folders_of(log) == folders
