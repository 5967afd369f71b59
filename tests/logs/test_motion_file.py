"""A motion inside a model's file: what is read is what was written, and nothing else is accepted."""

import base64
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from cdia_pin import read_log
from cdia_pin.errors import LogError
from cdia_pin.logs import motion_file
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.motion_file import motion_document, motion_from
from cdia_pin.resources import logs_dir
from cdia_pin.robot import load_robot


@pytest.fixture(scope="module")
def motion():
    robot = load_robot("ur5")
    return condition(read_log(logs_dir() / "demo_ur5.csv", robot).slice(0, 1500), robot)


def packed(**arrays):
    file = BytesIO()
    np.savez_compressed(file, **arrays)
    return base64.b64encode(file.getvalue()).decode("ascii")


def test_a_motion_is_read_as_it_was_written(motion):
    read = motion_from(motion_document(motion))
    for name in ("q", "v", "a", "effort", "effort_step", "speed_noise"):
        np.testing.assert_allclose(getattr(read, name), getattr(motion, name), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(read.time, motion.time, atol=1e-9)
    assert (read.joints, read.record, read.cutoff) == (motion.joints, motion.record, motion.cutoff)
    assert (read.kept == motion.kept).all()
    assert read.torque_side is motion.torque_side


def test_temperature_and_tolerance_are_kept(motion):
    n = len(motion.joints)
    warm = replace(motion, temperature=np.full_like(motion.q, 30.0), effort_tolerance=np.full(n, 0.1))
    read = motion_from(motion_document(warm))
    np.testing.assert_allclose(read.temperature, 30.0)
    np.testing.assert_allclose(read.effort_tolerance, 0.1)


@pytest.mark.parametrize(
    "wrong",
    [
        {"arrays": "no base64!"},
        {"arrays": base64.b64encode(b"no npz").decode()},
        {"arrays": packed(q=np.zeros((5, 6)))},
        {"joints": ["a", "b"]},
        {"rate": 0.0},
        {"rate": "fast"},
        {"torque_side": "left"},
    ],
    ids=lambda w: next(iter(w.items()))[0],
)
def test_anything_else_is_refused_in_one_line(motion, wrong):
    with pytest.raises(LogError) as error:
        motion_from({**motion_document(motion), **wrong})
    assert "\n" not in str(error.value)


def test_a_small_file_with_huge_arrays_is_refused(motion, monkeypatch):
    monkeypatch.setattr(motion_file, "LARGEST", 1000)
    with pytest.raises(LogError, match="too large"):
        motion_from(motion_document(motion))
