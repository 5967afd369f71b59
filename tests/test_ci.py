"""What continuous integration cannot do on a machine, it says loudly, and does not fail for it."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CI = Path(__file__).resolve().parents[1] / ".ci"


@pytest.fixture
def without_fuzzer(tmp_path):
    """A folder as an environment whose Python has no fuzzer and installs nothing."""
    program = tmp_path / "bin" / "python"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nexit 1\n")
    program.chmod(0o755)
    return tmp_path


def test_without_the_fuzzer_it_is_said_and_passes(without_fuzzer, tmp_path):
    again = tmp_path / "skipped"
    environment = os.environ | {"VENV": str(without_fuzzer), "CI_SKIPPED": str(again)}
    done = subprocess.run([CI / "fuzz"], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "NOT DONE: fuzz: atheris cannot be installed here; nothing was fuzzed" in done.stderr
    assert again.read_text().startswith("NOT DONE: fuzz")


@pytest.mark.parametrize("code", [0, 2])
def test_the_whole_run_says_it_again_at_its_end(tmp_path, code):
    (tmp_path / ".ci").mkdir()
    for name in ("run", "skipped"):
        shutil.copy(CI / name, tmp_path / ".ci" / name)
    make = tmp_path / "make"
    make.write_text(
        f"#!/bin/sh\n[ $1 = lint ] && .ci/skipped 'something'\n[ $1 = audit ] && exit {code}\necho did $1 >&2\n"
    )
    make.chmod(0o755)
    environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    done = subprocess.run(
        [tmp_path / ".ci" / "run"], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == code
    assert done.stderr.splitlines()[-1] == "NOT DONE: something"
