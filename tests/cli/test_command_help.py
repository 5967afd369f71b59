"""Every command explains itself with an example, quickly."""

import subprocess
import sys

import pytest
import typer

from cdia_pin.cli.program import app

COMMANDS = sorted(typer.main.get_command(app).commands)
PAGES = ("app", "view")  # serve pages until they are ended: they have no result for machines


def test_the_commands_are_listed(cdia):
    outcome = cdia("--help")
    assert outcome.code == 0
    assert all(name in outcome.out for name in COMMANDS)
    assert cdia().out == outcome.out


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example_and_json(cdia, name):
    outcome = cdia(name, "--help")
    assert outcome.code == 0
    _, example = outcome.out.split("Example", 1)
    assert f"cdia {name}" in example
    assert ("--json" in outcome.out) == (name not in PAGES)


def test_the_version(cdia):
    import cdia_pin

    assert cdia("--version").out.strip() == f"cdia-pin {cdia_pin.__version__}"


def python(code: str, **environment: str) -> str:
    import os

    env = {**{k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}, **environment}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env
    ).stdout


def test_help_loads_nothing_heavy():
    loaded = python("import sys; from cdia_pin.cli import main; main(['--help']); print(*sys.modules)")
    assert not {"numpy", "scipy", "pinocchio", "pyarrow", "numba"} & set(loaded.split())


def test_small_matrices_get_one_thread_unless_the_user_says_otherwise():
    show = "print(os.environ['OPENBLAS_NUM_THREADS'])"
    code = f"import os; from cdia_pin.cli import main; main(['--version']); {show}"
    assert python(code).split()[-1] == "1"
    assert python(code, OPENBLAS_NUM_THREADS="3").split()[-1] == "3"
