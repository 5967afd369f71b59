"""A number that makes no sense is refused in one line, before anything is read, whatever the option."""

import functools
import typing

import pytest
import typer

from cdia_pin.cli.program import app

ROBOT = ["--robot", "double_pendulum"]
# what a command needs besides its options, none of which exists
NEEDED = {
    "check": ["no.csv", *ROBOT],
    "compare": ["no.csv", *ROBOT],
    "discover": ["no.csv", *ROBOT],
    "identify": ["no.csv", *ROBOT],
    "add": ["coulomb_friction@joint2", "no.csv", *ROBOT],
    "excite": [*ROBOT, "--out", "motion.csv"],
    "monitor": ["no.csv", *ROBOT],
    "calibrate": ["no.csv", "nor.csv", *ROBOT, "--known-payload", "1"],
    "convert": ["no.csv", "no.npz", *ROBOT],
    "simulate": [*ROBOT, "--out", "run.csv"],
    "view": ["--simulate", "--no-open", *ROBOT],
    "app": ["--no-open"],
    "fleet": ["add", "--robots", "no.toml", "--store", "no"],
    "trend": ["no"],
    "campaign": ["no.toml"],
    "tune": ["no.toml", "--false-alarms", "1"],
}
built_once = functools.cache(typer.main.get_command)
ABSURD = ["nan", "inf", "-inf", "1e300", "-1e300", "1e12", "-1", "1" + 30 * "0", "ten", "", "1e-300"]


def numbers() -> list[tuple[str, str, type]]:
    """Return command, option and type of every option that takes a number."""
    found = []
    for info in app.registered_commands:
        command = info.name or info.callback.__name__
        for hint in typing.get_type_hints(info.callback, include_extras=True).values():
            kind, *about = typing.get_args(hint) or (hint,)
            for number in (float, int):
                if number in (kind, *typing.get_args(kind)):
                    names = map(str, (about[0].default, *about[0].param_decls))  # typer sorts them later
                    option = next(name for name in names if name.startswith("--"))
                    found.append((command, option, number))
    return found


def test_every_command_with_numbers_is_tried():
    assert {command for command, *_ in numbers()} == set(NEEDED)
    assert len(numbers()) > 30


@pytest.mark.parametrize(("command", "option", "kind"), numbers())
def test_an_absurd_number_is_refused_in_one_line(cdia, tmp_path, monkeypatch, command, option, kind):
    monkeypatch.setattr("typer.main.get_command", built_once)
    monkeypatch.chdir(tmp_path)
    for text in ABSURD:
        if text == "1e-300" and (kind is int or option in {"--noise", "--model-error", "--clearance"}):
            continue  # as good as 0, or not an integer
        said = cdia(command, *NEEDED[command], f"{option}={text}").error
        assert f"'{option}'" in said and said.endswith(f"see cdia {command} --help"), said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--floor", "1e300"], "--floor is within 10 m of the base, given '1e300'"),
        (["--floor", "nan"], "--floor is within 10 m"),
        (["--acceleration", "inf"], "--acceleration is above 0 and up to 1e\\+06, given 'inf'"),
        (["--acceleration", "joint1=1e300"], "--acceleration is above 0"),
        (["--acceleration", "0"], "--acceleration is above 0"),
    ],
)
def test_an_absurd_number_in_a_text_is_refused(cdia, tmp_path, arguments, said):
    assert (
        said.replace("\\", "") in cdia("excite", *ROBOT, "--out", tmp_path / "motion.csv", *arguments).error
    )


def test_a_simulation_that_no_memory_holds_is_refused(cdia, tmp_path):
    long = ["--duration", "100000", "--rate", "100000"]
    assert "steps" in cdia("simulate", *ROBOT, "--out", tmp_path / "run.csv", *long).error
