"""Each command ends with the next one to type, and that line is a command with the user's own files and options."""

import re
import shlex
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from hypothesis import given, settings
from hypothesis import strategies as st

from cdia_pin import Dynamics, load_robot, read_log, save_model, write_log
from cdia_pin.cli.discover import _following
from cdia_pin.cli.next_command import again, follow, follow_checks, free
from cdia_pin.cli.program import app
from cdia_pin.effects import EFFECTS, parse_effect, parse_term
from cdia_pin.logs import LogCheck
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.resources import logs_dir
from tests.made_logs import make

ROBOT = ["--robot", "double_pendulum"]
COMMANDS = typer.main.get_command(app)


def context(words: list[str]):
    """What a command gets from what was typed after ``cdia``; raises where it is no command."""
    root = COMMANDS.make_context("cdia", list(words), obj=shlex.join(["cdia", *words]))
    name, command, rest = COMMANDS.resolve_command(root, root._protected_args + root.args)
    return command.make_context(name, rest, parent=root, obj=root.obj)


def next_line(text: str) -> list[str]:
    *_, last = [line for line in text.splitlines() if line.strip()]
    head, _, line = last.partition("next: ")
    assert not head, text
    return shlex.split(line)


NAMES = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), min_size=1, max_size=12).filter(
    lambda s: not s.startswith("-")
)
WORDS = st.one_of(NAMES, NAMES.map(lambda s: f"a {s} b"))
OPTIONS = {
    "--gains": WORDS,
    "--joint-map": WORDS,
    "--convert": WORDS,
    "--topic": WORDS,
    "--cutoff": st.floats(0.1, 100).map(str),
    "--environment": st.sampled_from(["air", "water"]),
    "--no-check": st.none(),
    "--contact": st.none(),
    "--model": WORDS,
}


@given(
    log=WORDS,
    robot=WORDS,
    options=st.fixed_dictionaries({}, optional=OPTIONS),
    target=st.sampled_from(["discover", "compare", "add", "check", "identify", "monitor", "excite"]),
)
@settings(max_examples=150, deadline=None)
def test_the_next_command_parses_and_keeps_what_the_user_said(log, robot, options, target):
    words = ["discover", log, "--robot", robot]
    for option, value in options.items():
        words += [option] if value is None else [option, value]
    before = context(words)
    arguments = {"add": ["payload", log], "excite": []}.get(target, [log])
    more = {"out": "motion.csv"} if target == "excite" else {}
    after = context(shlex.split(follow(before, target, *arguments, **more))[1:])
    assert after.params["robot"] == robot
    for name in (
        "gains",
        "joint_map",
        "convert",
        "topic",
        "cutoff",
        "environment",
        "check",
        "contact",
        "model",
    ):
        if name in after.params:
            assert after.params[name] == before.params[name]


@given(log=WORDS, robot=WORDS)
@settings(max_examples=30, deadline=None)
def test_the_same_command_with_one_option_more_parses(log, robot):
    before = context(["discover", log, "--robot", robot, "--all"])
    after = context(shlex.split(again(before, save="a model.json"))[1:])
    changed = {k: v for k, v in after.params.items() if v != before.params[k]}
    assert list(changed) == ["save"]


def test_a_file_that_exists_is_not_proposed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert str(free("model.json")) == "model.json"
    (tmp_path / "model.json").touch()
    assert str(free("model.json")) == "model2.json"


@pytest.mark.parametrize(
    ("typed", "then"),
    [
        (["robots"], "robots"),
        (["robots", "ur5"], "check"),
        (["effects"], "effects"),
        (["effects", "payload"], "add"),
        (["check", "LOG", *ROBOT], "compare"),
        (["compare", "LOG", *ROBOT, "--no-check"], "discover"),
        (["discover", "LOG", *ROBOT, "--no-check", "--effects", "coulomb_friction"], "discover"),
        (
            [
                "discover",
                "LOG",
                *ROBOT,
                "--no-check",
                "--effects",
                "coulomb_friction",
                "--save",
                "OUT/m.json",
            ],
            "export",
        ),
        (["add", "coulomb_friction@joint2", "LOG", *ROBOT, "--save", "OUT/added.json"], "compare"),
        (["identify", "LOG", *ROBOT], "identify"),
        (["convert", "LOG", "OUT/x.npz", *ROBOT], "check"),
        (["simulate", *ROBOT, "--duration", "5", "--out", "OUT/s.csv"], "discover"),
        (["export", *ROBOT, "--model", "MODEL", "--urdf", "OUT/m.urdf"], "compare"),
        (["study", "scara-model"], "study"),
    ],
)
def test_a_command_ends_with_the_next_one(cdia, log, tmp_path, typed, then):
    robot = load_robot("double_pendulum")
    model = save_model(Dynamics(robot, (parse_term("payload: mass=0.1"),)), tmp_path / "model.json")
    files = {"LOG": log, "OUT": tmp_path, "MODEL": model}
    words = [re.sub("LOG|OUT|MODEL", lambda found: str(files[found[0]]), w) for w in typed]
    done = cdia(*words)
    assert done.code == 0, done.err
    program, *line = next_line(done.out)
    assert program == "cdia"
    assert line[0] == then
    context(line)


@pytest.mark.parametrize("name", EFFECTS)
def test_the_command_after_an_effect_adds_it(cdia, name):
    _, *line = next_line(cdia("effects", name).out)
    for joint in ("joint1", "joint2"):
        line = [word.replace("JOINT", joint, 1) for word in line]
    assert context(line).command.name == "add"
    effect = parse_effect(line[1], load_robot("double_pendulum"))
    assert effect.name == name


@pytest.mark.parametrize(
    ("term", "option"), [("payload: mass=0.1", "--urdf"), ("torque_offset@joint2: offset=1", "--ranges")]
)
def test_the_export_after_a_search_is_one_that_holds_what_was_found(cdia, tmp_path, term, option):
    model = Dynamics(load_robot("double_pendulum"), (parse_term(term),))
    file = save_model(model, tmp_path / "model.json")
    found = SimpleNamespace(model=model, steps=[term], verdict="explained")
    line = shlex.split(_following(context(["discover", "LOG", *ROBOT]), found, [Path("LOG")], file))
    assert line[-2] == option
    assert cdia(*line[1:-1], tmp_path / line[-1]).code == 0


ELBOW = "flip_effort=elbow_joint"


@pytest.mark.parametrize(
    ("advice", "more", "then"),
    [
        ([f"--convert {ELBOW}"], [], f"cdia compare --convert {ELBOW} LOG --robot ur5"),
        ([f"--convert {ELBOW}", ""], [], ""),  # one of two logs is right
        (["record it again"], [], ""),
        ([f"--convert {ELBOW}"], ["--convert", ELBOW], ""),  # it was given, and mends nothing
    ],
)
def test_a_log_that_contradicts_its_robot_is_mended_before_it_is_used(advice, more, then):
    error = [Finding(Topic.SIGN, Severity.ERROR, "flipped", advice=text) for text in advice]
    checks = [LogCheck("log", "ur5", (finding,) if finding.advice else ()) for finding in error]
    ctx = context(["compare", "LOG", "--robot", "ur5", *more])
    assert follow_checks(ctx, checks, "discover", Path("LOG")) == then


FITS = Finding(Topic.ROBOT, Severity.WARNING, "of another arm", value={"best": "ur3", "same_joints": True})
OF_OTHER_JOINTS = replace(FITS, value={**FITS.value, "same_joints": False})


@pytest.mark.parametrize(
    ("typed", "findings", "then"),
    [
        (["--robot", "ur5"], [FITS], "cdia compare --robot ur3 LOG"),
        (["--robot=ur5"], [FITS, FITS], "cdia compare --robot ur3 LOG"),
        (["-rur5", "--report", "-r"], [FITS], "cdia compare --robot ur3 LOG --report -r"),
        (["-r", "ur5"], [FITS, None], ""),  # one of two logs is of the arm
        (["-r", "ur5"], [replace(FITS, value={**FITS.value, "best": "ur10"}), FITS], ""),
        (["-r", "ur5"], [OF_OTHER_JOINTS], "cdia discover LOG --robot ur5"),
    ],
)
def test_logs_of_another_arm_are_read_with_that_arm_before_they_are_used(typed, findings, then):
    checks = [LogCheck("log", "ur5", (finding,) if finding else ()) for finding in findings]
    ctx = context(["compare", "LOG", *typed])
    assert follow_checks(ctx, checks, "discover", Path("LOG")) == then


def test_a_search_on_a_log_of_another_arm_ends_with_the_arm_that_fits(cdia, tmp_path):
    write_log(make(load_robot("ur10"), duration=8.0, noise=0.02).log, tmp_path / "large.csv")
    done = cdia("discover", tmp_path / "large.csv", "--robot", "ur5", "--effects", "payload", "--anyway")
    assert "This result is doubtful" in done.out
    assert context(next_line(done.out)[1:]).params["robot"] == "ur10"


def test_after_a_check_that_finds_degrees_the_next_command_reads_degrees(cdia, tmp_path):
    robot = load_robot("ur5")
    log = read_log(logs_dir() / "demo_ur5.csv", robot)
    write_log(replace(log, position=np.degrees(log.position), velocity=None), tmp_path / "degrees.csv")
    done = cdia("check", tmp_path / "degrees.csv", "--robot", "ur5")
    _, *line = next_line(done.out)
    assert line[0] == "check" and context(line).params["convert"] == ["angle=deg"]
    assert next_line(cdia(*line).out)[1] == "compare"
