"""A file is written whole or not at all: whatever happens meanwhile, the old one stays."""

import ast
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cdia_pin.whole_files import whole_file, write_whole

PACKAGE = Path(__file__).resolve().parents[1] / "cdia_pin"
WRITES = {"write_text", "write_bytes", "savefig", "write_table", "savez", "savez_compressed", "save"}
# by their file: how they write whole, or why they need not
ALLOWED = {
    "whole_files.py": "the writer",
    "diagnosis/event_log_file.py": "lines appended while an arm moves; a cut line is taken back",
    "diagnosis/kernel_cache.py": "a draft that is renamed",
    "viewers/study_figures.py": "into memory",
    "viewers/arm_figures.py": "into memory",
    "logs/motion_file.py": "into memory",
    "logs/log_writer.py": "into the file that the writer gives",
    "campaigns/run_store.py": "into the file that the writer gives",
    "fleet/store.py": "into the file that the writer gives",
    "viewers/arm_page.py": "a method of that name, which uses the writer",
}


@given(old=st.binary(max_size=50), new=st.binary(max_size=200), fails_at=st.integers(0, 300))
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_failure_at_any_byte_leaves_the_old_file_and_nothing_else(tmp_path, old, new, fails_at):
    path = tmp_path / "file"
    path.write_bytes(old)
    try:
        with whole_file(path) as file:
            for k, byte in enumerate(new):
                if k == fails_at:
                    raise OSError(28, "No space left on device")
                file.write(bytes([byte]))
    except OSError:
        assert path.read_bytes() == old
    else:
        assert path.read_bytes() == new
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_a_symlink_stays_and_what_it_names_is_written(tmp_path):
    (tmp_path / "real").mkdir()
    target = tmp_path / "real" / "model.json"
    target.write_text("old")
    link = tmp_path / "link.json"
    link.symlink_to(target)
    write_whole(link, "new")
    assert link.is_symlink() and target.read_text() == "new"
    dangling = tmp_path / "later.json"
    dangling.symlink_to(tmp_path / "real" / "later.json")
    write_whole(dangling, "new")
    assert dangling.is_symlink() and (tmp_path / "real" / "later.json").read_text() == "new"


def test_the_rights_of_a_file_stay_and_those_of_a_new_one_are_usual(tmp_path):
    old = tmp_path / "old"
    old.write_text("old")
    old.chmod(0o640)
    write_whole(old, "new")
    assert stat.S_IMODE(old.stat().st_mode) == 0o640
    usual, new = tmp_path / "usual", tmp_path / "new"
    usual.write_text("")
    write_whole(new, "new")
    assert new.stat().st_mode == usual.stat().st_mode


def test_a_device_takes_what_comes():
    write_whole("/dev/null", "nothing")
    with pytest.raises(OSError, match="space"):
        write_whole("/dev/full", "too much")


@pytest.mark.parametrize("size", [0, 1, 4095, 4096, 1_000_000])
def test_a_killed_program_leaves_the_old_file(tmp_path, size):
    path = tmp_path / "model.json"
    path.write_text("old")
    program = (
        "import os, signal, sys\n"
        "from cdia_pin.whole_files import whole_file\n"
        "with whole_file(sys.argv[1]) as file:\n"
        "    file.write(bytes(int(sys.argv[2]))); file.flush(); os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", program, str(path), str(size)], check=False)
    assert done.returncode == -signal.SIGKILL
    assert path.read_text() == "old"


def writes(path: Path) -> list[str]:
    """Calls that write a file, as ``line: name``."""
    out = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        modes = [a.value for a in node.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
        opened = name == "open" and any(set(m) <= set("rwaxbt+") and set(m) & set("wax+") for m in modes)
        if opened or name in WRITES:
            out.append(f"{node.lineno}: {name}")
    return out


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_every_file_is_written_by_the_one_writer(path):
    if str(path.relative_to(PACKAGE)) not in ALLOWED:
        assert not writes(path), f"use cdia_pin.whole_files: {writes(path)}"
