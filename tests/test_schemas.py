"""Every JSON document of the package has a schema name, and each name stands in one place."""

import re
from pathlib import Path

from cdia_pin import schemas

PACKAGE = Path(schemas.__file__).parent
NAMES = {name: value for name, value in vars(schemas).items() if name.isupper()}


def test_a_name_has_a_version():
    assert all(re.fullmatch(r"cdia-[a-z-]+/\d+", value) for value in NAMES.values())


def test_no_two_documents_share_a_name():
    assert len(set(NAMES.values())) == len(NAMES)


def test_no_module_writes_a_name_itself():
    written = [
        f"{path.relative_to(PACKAGE)}: {name}"
        for path in PACKAGE.rglob("*.py")
        if path.name != "schemas.py"
        for name in re.findall(r'["\'](cdia-[a-z-]+/\d+)["\']', path.read_text(encoding="utf-8"))
    ]
    assert not written


def test_every_name_is_used():
    text = "".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    assert [name for name in NAMES if f"schemas.{name}" not in text] == []
