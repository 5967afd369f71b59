"""``import cdia_pin`` is light, and its names are found when they are used."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import cdia_pin

ROOT = Path(__file__).resolve().parents[1]
HEAVY = ("numpy", "scipy", "pinocchio", "numba", "pyarrow", "typer", "rich")


def loaded_by(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in run.stdout.split()}


def test_importing_the_package_loads_nothing_heavy():
    assert not loaded_by("import cdia_pin") & set(HEAVY)


def test_importing_the_command_loads_nothing_heavy():
    assert not loaded_by("import cdia_pin.cli") & {"numpy", "scipy", "pinocchio", "numba", "pyarrow"}


def test_importing_every_public_name_does_not_load_numba():
    names = ", ".join(n for n in cdia_pin.__all__ if n != "__version__")
    assert "numba" not in loaded_by(f"from cdia_pin import {names}")


@pytest.mark.parametrize("name", cdia_pin.__all__)
def test_public_names_are_there(name):
    assert getattr(cdia_pin, name) is not None
    assert name in dir(cdia_pin)


def test_dir_shows_the_public_names_alone():
    assert dir(cdia_pin) == sorted(cdia_pin.__all__)
    assert not [name for name in dir(cdia_pin) if name.startswith("_") and name != "__version__"]


def test_star_imports_the_public_names():
    names: dict[str, object] = {}
    exec("from cdia_pin import *", names)
    assert set(names) - {"__builtins__"} == set(cdia_pin.__all__)


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.py")), ids=lambda p: p.name)
def test_an_example_imports_from_the_package_alone(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        named = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        named += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        assert not [name for name in named if name.startswith("cdia_pin.")]


def test_the_readme_imports_from_the_package_alone():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert not re.findall(r"(?:from|import) cdia_pin\.", text)
    for names in re.findall(r"from cdia_pin import ([\w, ]+)", text):
        assert {name.strip() for name in names.split(",")} <= set(cdia_pin.__all__)


def test_effects_is_the_module():
    from cdia_pin import effects

    assert cdia_pin.effects is effects
    assert effects.EFFECTS


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="no_such_name"):
        cdia_pin.no_such_name  # noqa: B018


def test_every_room_can_be_imported_first():
    # A circle of imports shows only where a process begins with the wrong room: each has a process of its own.
    code = """
import importlib, os, sys
import numpy, pinocchio, scipy.linalg, scipy.optimize, scipy.signal  # what all rooms share, imported once
import cdia_pin
for home in sorted(set(cdia_pin._HOME.values()) - {"cdia_pin"}):
    if not (child := os.fork()):
        importlib.import_module(home)
        os._exit(0)
    if os.waitpid(child, 0)[1]:
        print(home)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == [], run.stderr
