"""Every reference key in the package resolves in docs/references.md, and none is listed for nothing."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
KEY = re.compile(r"\[((?:[A-Z][A-Za-z]+\d{4}[a-z]?)|Thesis)\]")
ENTRY = re.compile(r"^- \*\*\[(\w+)\]\*\* ", re.MULTILINE)


def keys_used() -> dict[str, list[str]]:
    used: dict[str, list[str]] = {}
    for path in sorted((ROOT / "cdia_pin").rglob("*.py")):
        for key in KEY.findall(path.read_text(encoding="utf-8")):
            used.setdefault(key, []).append(str(path.relative_to(ROOT)))
    return used


def keys_listed() -> list[str]:
    return ENTRY.findall((ROOT / "docs" / "references.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("key", sorted(keys_used()))
def test_a_key_that_is_used_is_listed(key):
    assert key in keys_listed(), f"add [{key}] of {', '.join(keys_used()[key])} to docs/references.md"


@pytest.mark.parametrize("key", keys_listed())
def test_a_key_that_is_listed_is_used(key):
    assert key in keys_used()


def test_keys_are_listed_once_and_in_order():
    assert keys_listed() == sorted(set(keys_listed()))
