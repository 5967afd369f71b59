"""``import cdia_pin`` is light, and its names are found when they are used."""

import subprocess
import sys

import pytest

import cdia_pin

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


def test_effects_is_the_module():
    from cdia_pin import effects

    assert cdia_pin.effects is effects
    assert effects.EFFECTS


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="no_such_name"):
        cdia_pin.no_such_name  # noqa: B018
