"""The examples are short, and use what is public; the build of the site runs them."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NUMBERED = sorted(EXAMPLES.glob("*.py"))
OF_ROBOTS = sorted((EXAMPLES / "robots").glob("*.py"))
LONGEST = 60  # lines
LONGEST_OF_A_ROBOT = 140  # lines; it reads its signals and its command line, too


@pytest.mark.parametrize("path", NUMBERED, ids=lambda path: path.stem)
def test_an_example_is_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) < LONGEST


@pytest.mark.parametrize("path", OF_ROBOTS, ids=lambda path: path.stem)
def test_a_program_for_a_robot_is_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) < LONGEST_OF_A_ROBOT


@pytest.mark.parametrize("path", NUMBERED, ids=lambda path: path.stem)
def test_an_example_ends_with_a_number_that_it_prints(path):
    *_, last = ast.parse(path.read_text(encoding="utf-8")).body
    printed = [n for n in ast.walk(last) if isinstance(n, ast.Call) and ast.unparse(n.func) == "print"]
    assert any(
        part.format_spec
        for n in ast.walk(printed[-1])
        if isinstance(n, ast.JoinedStr)
        for part in n.values
        if isinstance(part, ast.FormattedValue)
    )


def test_examples_are_numbered_from_one():
    assert [path.name[:3] for path in NUMBERED] == [f"{k:02d}_" for k in range(1, len(NUMBERED) + 1)]


@pytest.mark.parametrize("path", [*NUMBERED, *OF_ROBOTS], ids=lambda path: path.stem)
def test_an_example_uses_public_names(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cdia_pin"):
            public = import_module(node.module).__all__
            assert {alias.name for alias in node.names} <= set(public), node.module
