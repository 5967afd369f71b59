"""The browser for the tests is installed by root, or where sudo was asked for; nothing uses sudo unasked."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

INSTALL = Path(__file__).parent / "browser" / "install"
BASH = shutil.which("bash") or "bash"


def called(folder, user, asked=None, fails=False):
    """Run the script where apt-get, sudo and id are recorded; return what was called, and what was said."""
    log = folder / "called"
    log.write_text("")
    programs = {
        "id": f"echo {user}",
        "apt-get": f'echo "apt-get $*" >> {log}; exit {int(fails)}',
        "sudo": f'echo sudo >> {log}; "$@"',
        "env": 'shift; "$@"',
    }
    for name, does in programs.items():
        program = folder / name
        program.write_text(f"#!{BASH}\n{does}\n")
        program.chmod(0o755)
    environment = {"PATH": str(folder)} | ({"CDIA_INSTALL_BROWSER": asked} if asked else {})
    done = subprocess.run([BASH, str(INSTALL)], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    return log.read_text().splitlines(), done.stderr


def test_root_installs_without_sudo(tmp_path):
    did, said = called(tmp_path, user=0)
    assert [line.split()[1] for line in did] == ["update", "install"] and "chromium" in did[-1]
    assert not said


@pytest.mark.parametrize("asked", [None, "yes"])
def test_another_user_is_told_the_command(tmp_path, asked):
    did, said = called(tmp_path, user=1000, asked=asked)
    assert not did
    assert "CDIA_INSTALL_BROWSER=sudo tests/browser/install" in said and "skipped" in said


def test_sudo_is_used_where_it_was_asked_for(tmp_path):
    did, _ = called(tmp_path, user=1000, asked="sudo")
    assert did[0] == "sudo" and did[1].startswith("apt-get update") and did.count("sudo") == 2


def test_a_failure_is_said_and_ends_nothing(tmp_path):
    _, said = called(tmp_path, user=0, fails=True)
    assert "could not be installed" in said


def test_it_may_be_run():
    assert os.access(INSTALL, os.X_OK)
