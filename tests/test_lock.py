"""The lock file holds what pyproject asks for, in exact versions with hashes, and names no registry."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements.lock"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = {"": PROJECT["dependencies"], **PROJECT["optional-dependencies"]}
WANTED = [
    *PROJECT["dependencies"],
    *(
        one
        for extra in ("view", "app", "ros", "figures", "robots")
        for one in PROJECT["optional-dependencies"][extra]
    ),
]


# the least version without a known vulnerability, and the last one that it mends
FLOORS = {
    "distributed": ("2026.1.0", "CVE-2026-23528: a link runs code by way of the dashboard"),
    "lxml": ("6.1.0", "CVE-2026-41066: two of its parsers read local files that a document names"),
    "nicegui": ("3.12.0", "CVE-2026-45553, CVE-2026-45554"),
    "pillow": ("13.0.0", "CVE-2026-96639: an image writes outside of its memory"),
    "pyarrow": ("14.0.1", "CVE-2023-47248: a file runs code"),
    "starlette": ("1.3.0", "PYSEC-2026-248, after CVE-2026-48710 and CVE-2025-62727"),
}


@pytest.mark.parametrize("name", FLOORS)
def test_no_version_with_a_known_vulnerability_is_taken(name):
    asked = [Requirement(one) for extra in EXTRAS for one in EXTRAS[extra]]
    (least,) = {
        Version(spec.version)
        for one in asked
        if one.name == name
        for spec in one.specifier
        if spec.operator == ">="
    }
    safe, _ = FLOORS[name]
    assert least >= Version(safe)
    assert all(Version(version) >= least for locked_name, version in locked() if locked_name == name)


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
