"""The messages that the page on troubleshooting quotes are those of the program."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "troubleshooting.md"
QUOTED = re.compile(r"^`(.+)`\n: ", re.MULTILINE)
HOLE = "…"  # stands for names and numbers
MESSAGES = QUOTED.findall(PAGE.read_text(encoding="utf-8"))


@cache
def texts() -> list[str]:
    """Every text in the source of the package, with a hole for each name or number that is put into it."""
    found = []
    for path in sorted((ROOT / "cdia_pin").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = (p.value if isinstance(p, ast.Constant) else HOLE for p in node.values)
                found.append("".join(parts))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.append(re.sub(r"\{.*?\}", HOLE, node.value))
    return found


def says(text: str, fragments: list[str]) -> bool:
    """Whether a text holds fragments one after another."""
    at = 0
    for fragment in fragments:
        at = text.find(fragment, at)
        if at < 0:
            return False
        at += len(fragment)
    return True


def test_messages_are_quoted():
    assert len(MESSAGES) > 10


@pytest.mark.parametrize("message", MESSAGES)
def test_a_quoted_message_is_in_the_program(message):
    fragments = [fragment.strip() for fragment in message.split(HOLE)]
    assert any(says(text, fragments) for text in texts()), message
