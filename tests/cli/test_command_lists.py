"""``cdia robots`` and ``cdia effects``."""

import re
from importlib import import_module

import pytest

from cdia_pin.effects import EFFECTS
from cdia_pin.effects.expression import FUNCTIONS
from cdia_pin.robot import catalogue


def test_every_robot_is_listed(cdia):
    found = cdia("robots", "--json", "-").json
    assert found["schema"] == "cdia-robots/1"
    assert [r["name"] for r in found["robots"]] == list(catalogue())
    shown = cdia("robots").out
    assert all(name in shown for name in catalogue())


def test_a_robot_that_is_fetched_is_listed_with_joints_licence_and_source(cdia, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (ur5e,) = [r for r in cdia("robots", "--json", "-").json["robots"] if r["name"] == "ur5e"]
    assert (ur5e["count"], ur5e["licence"], ur5e["source"]) == (6, "BSD-3-Clause", "robot_descriptions")
    assert not ur5e["available"]
    assert "cdia-pin[robots]" in cdia("robots").out


def test_one_robot_shows_its_joints(cdia):
    shown = cdia("robots", "ur5").out
    assert "elbow_joint" in shown
    assert "rad/s" in shown


def test_a_urdf_file_is_a_robot(cdia):
    path = catalogue()["scara"].path
    (entry,) = cdia("robots", path, "--json", "-").json["robots"]
    assert entry["joints"] == ["joint1", "joint2", "joint3", "joint4"]


def test_a_file_with_the_name_of_a_robot_that_is_not_here_is_the_file(cdia, tmp_path, monkeypatch):
    def no_network(*arguments):
        raise AssertionError("it was to be fetched")

    monkeypatch.setattr(import_module("cdia_pin.robot.catalogue"), "fetched_urdf", no_network)
    away = next(name for name, entry in catalogue().items() if not entry.available)
    file = tmp_path / f"{away}.urdf"
    file.write_text(catalogue()["scara"].path.read_text())
    (entry,) = cdia("robots", file, "--json", "-").json["robots"]
    assert (entry["name"], entry["source"], entry["count"]) == (away, "file", 4)


def test_a_robot_with_two_arms_becomes_one_arm(cdia, tmp_path):
    path, alone = catalogue()["baxter_left_arm"].path, tmp_path / "left.urdf"
    said = cdia("check", tmp_path / "log.csv", "--robot", path).err
    assert "cdia robots" in said and "--save arm.urdf" in said
    done = cdia("robots", path, "--lock", "right_*, head_pan=0.2", "--save", alone)
    assert done.code == 0
    assert done.out.rstrip().endswith(f"next: cdia check LOG --robot {alone}")
    (entry,) = cdia("robots", alone, "--json", "-").json["robots"]
    assert entry["count"] == 7


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--lock", "head"], "need a robot"),
        (["scara", "--lock", "joint1=half"], "must be a number"),
        (["scara", "--lock", "joint1=nan"], "must be a number"),
        (["scara", "--lock", "elbow"], "unknown joint 'elbow'"),
        (["scara", "--lock", "joint*"], "no movable joint is left"),
    ],
)
def test_a_lock_that_makes_no_sense_is_refused(cdia, words, said):
    done = cdia("robots", *words)
    assert done.code == 2
    assert said in done.err


def test_every_effect_is_listed_with_equation_and_units(cdia):
    found = cdia("effects", "--json", "-").json
    assert found["schema"] == "cdia-effects/1"
    assert [e["effect"] for e in found["effects"]] == list(EFFECTS)
    assert all(p["unit"] for e in found["effects"] for p in e["parameters"])
    shown = cdia("effects").out
    assert all(name in shown for name in EFFECTS)


@pytest.mark.parametrize("name", EFFECTS)
def test_each_effect_explains_itself(cdia, name):
    outcome = cdia("effects", name)
    assert outcome.code == 0
    assert EFFECTS[name].equation in outcome.out


# Names of the source, such as `FUNCTIONS`, tell a reader in a terminal nothing.
INTERNAL = re.compile(r"`|\b(?!(?:JOINT|LOG|URDF)\b)[A-Z]+(?:_[A-Z]+|[A-Z]{3})\w*")


@pytest.mark.parametrize("name", EFFECTS)
def test_what_is_said_of_an_effect_names_nothing_of_the_source(cdia, name):
    said = cdia("effects", name).out
    assert not INTERNAL.findall(said), said


def test_the_functions_of_an_expression_are_listed(cdia):
    said = " ".join(cdia("effects", "expression").out.split())
    assert f"the functions {', '.join(FUNCTIONS)}." in said


def test_units_follow_the_joint(cdia):
    (entry,) = cdia("effects", "viscous_friction", "--json", "-").json["effects"]
    (parameter,) = entry["parameters"]
    assert (parameter["unit"], parameter["unit_sliding"]) == ("N·m·s/rad", "N·s/m")
