"""Small input files are files, and small: no pipe blocks, no device and no giant file fills the memory."""

import os

import pytest

from cdia_pin import load_robot
from cdia_pin.dynamics import load_model
from cdia_pin.errors import CdiaError
from cdia_pin.input_files import LARGEST, read_text
from cdia_pin.logs.gains import read_gains


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


@pytest.fixture(params=["pipe", "device", "giant", "folder"])
def odd(request, tmp_path):
    file = tmp_path / "odd.json"
    if request.param == "pipe":
        os.mkfifo(file)
    elif request.param == "device":
        file.symlink_to("/dev/zero")
    elif request.param == "folder":
        file.mkdir()
    else:
        with file.open("wb") as sparse:
            sparse.truncate(LARGEST + 1)
    return file


def test_what_is_no_small_file_is_refused(odd, robot):
    with pytest.raises(OSError, match=r"pipe|directory|MB"):
        read_text(odd)
    for read in (
        lambda: load_model(odd, robot),
        lambda: read_gains(odd, robot.joints),
        lambda: load_robot(odd),
    ):
        with pytest.raises(CdiaError):
            read()


def test_a_text_is_read(tmp_path):
    (tmp_path / "a.txt").write_text("τ", encoding="utf-8")
    assert read_text(tmp_path / "a.txt") == "τ"
