"""The lock file holds what pyproject asks for, in exact versions with hashes, and names no registry."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements.lock"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
WANTED = [
    *PROJECT["dependencies"],
    *(
        one
        for extra in ("view", "app", "ros", "figures", "robots")
        for one in PROJECT["optional-dependencies"][extra]
    ),
]


def locked() -> list[tuple[str, str]]:
    """Name and version of each entry of the lock file; newer Pythons may have an entry of their own."""
    return re.findall(r"^([a-z0-9.-]+)==([^ ;\\]+)", LOCK.read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.parametrize("wanted", [w for w in WANTED if not w.startswith("cdia-pin")])
def test_the_lock_holds_what_is_asked_for(wanted):
    asked = Requirement(wanted)
    versions = [version for name, version in locked() if name == asked.name.lower()]
    assert versions and all(map(asked.specifier.contains, versions)), "run make lock"


def test_every_version_has_a_hash_and_no_address_is_named():
    text = LOCK.read_text(encoding="utf-8")
    entries = re.split(r"\n(?=[a-z0-9])", text.split("\n", 2)[2])
    assert len(entries) == len(locked()) > 50
    assert all("--hash=sha256:" in entry for entry in entries)
    assert "://" not in text and "index-url" not in text
