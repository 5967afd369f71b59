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

ROOT = Path(__file__).resolve().parents[1]
WRITERS = sorted(f for room in ("cdia_pin", "benchmarks") for f in (ROOT / room).rglob("*.py"))
WRITES = {"write_text", "write_bytes", "savefig", "write_table", "savez", "savez_compressed", "save"}
OPENS = {"open", "fdopen"}
# by their file: how they write whole, or why they need not
ALLOWED = {
    "cdia_pin/whole_files.py": "the writer",
    "cdia_pin/diagnosis/event_log_file.py": "lines appended while an arm moves; a cut line is taken back",
    "cdia_pin/diagnosis/kernel_cache.py": "a draft that is renamed",
    "cdia_pin/viewers/study_figures.py": "into memory",
    "cdia_pin/viewers/arm_figures.py": "into memory",
    "cdia_pin/logs/motion_file.py": "into memory",
    "cdia_pin/logs/log_writer.py": "into the file that the writer gives",
    "cdia_pin/campaigns/run_store.py": "into the file that the writer gives",
    "cdia_pin/fleet/store.py": "into the file that the writer gives",
    "cdia_pin/viewers/arm_page.py": "a method of that name, which uses the writer",
    "cdia_pin/fault_report.py": "a new file, which replaces none",
    "cdia_pin/viewers/door.py": "a new file, which nobody else may read from its first byte on",
    "benchmarks/golden/run.py": "a draft that is renamed, since it also runs older states of the package",
    "benchmarks/outcomes.py": "lines appended while a run goes on; a line that was cut is left out",
    "benchmarks/newcomer/newcomer.py": "into a temporary folder",
    "benchmarks/peers/figaroh_fit.py": "into a temporary folder; runs where the package is not",
    "benchmarks/peers/figaroh_process.py": "into a temporary folder",
    "benchmarks/plant/cache.py": "a draft that is renamed",
    "benchmarks/plant/plant.py": "a function of that name, which renames a draft",
    "benchmarks/recordings.py": "into the file that the writer gives",
    "benchmarks/real_residuals/bases.py": "into a temporary folder",
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


def writes(text: str) -> list[str]:
    """Calls that write a file in the text of a module, as ``line: name``."""
    out = []
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        given = [*node.args, *(k.value for k in node.keywords if k.arg == "mode")]
        modes = [a.value for a in given if isinstance(a, ast.Constant) and isinstance(a.value, str)]
        opened = name in OPENS and any(set(m) <= set("rwaxbt+") and set(m) & set("wax+") for m in modes)
        if opened or name in WRITES:
            out.append(f"{node.lineno}: {name}")
    return out


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("open('a', 'w')", True),
        ("path.open(mode='ab')", True),
        ("os.fdopen(handle, 'wb')", True),
        ("os.fdopen(handle, mode='r+')", True),
        ("path.write_text('')", True),
        ("open('log', 'rb')", False),
        ("path.open(encoding='utf-8')", False),
        ("os.fdopen(handle)", False),
        ("write_whole(path, '')", False),
    ],
)
def test_what_writes_is_seen(text, found):
    assert bool(writes(text)) == found


@pytest.mark.parametrize("path", WRITERS, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_file_is_written_by_the_one_writer(path):
    found = writes(path.read_text(encoding="utf-8"))
    if str(path.relative_to(ROOT)) in ALLOWED:
        assert found, "it writes nothing any more"
    else:
        assert not found, f"use cdia_pin.whole_files: {found}"
