"""Compiled code is kept, said to be compiled where that takes long, and compiled again where its file is broken."""

import importlib.util
import logging
import os
import sys
import time
from types import ModuleType

import pytest

from cdia_pin.diagnosis import kernel_cache
from cdia_pin.diagnosis.kernel_cache import first_call, forget, load
from cdia_pin.effects import CoulombFriction

TEXT = """
from numba import njit

@njit(cache=True)
def twice(x):
    return 2 * x
"""


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    """A function that imports the module as a new program would."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    path = tmp_path / "kept_twice.py"
    path.write_text(TEXT)

    def imported():
        spec = importlib.util.spec_from_file_location("kept_twice", path)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "kept_twice", module)
        spec.loader.exec_module(module)
        return module

    return imported


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("broken", [b"", b"not a pickle", b"\x80\x04"])
def test_a_broken_cache_heals(fresh, tmp_path, suffix: str, broken: bytes) -> None:
    assert fresh().twice(3.0) == 6.0
    files = list(tmp_path.rglob(f"*.{suffix}"))
    assert files
    for path in files:
        path.write_bytes(broken)
    module, got = fresh(), []
    first_call("a test", [module], lambda: got.append(module.twice(3.0)))
    assert got == [6.0]
    assert fresh().twice(4.0) == 8.0


def test_what_was_compiled_before_a_change_of_what_it_calls_is_forgotten(fresh, tmp_path) -> None:
    module = fresh()
    assert module.twice(3.0) == 6.0
    called = ModuleType("called")
    called.__file__ = str(tmp_path / "called.py")
    path = tmp_path / "called.py"
    path.write_text("")
    for later, kept in ((-60, True), (60, False)):
        os.utime(path, (time.time() + later,) * 2)
        first_call("a test", [module, called], lambda: None)
        assert any(tmp_path.rglob("kept_twice.*.nbi")) == kept


def test_an_error_of_the_code_itself_is_not_hidden(fresh) -> None:
    module = fresh()
    with pytest.raises(ZeroDivisionError):
        first_call("a test", [module], lambda: 1 / 0)
    assert forget([module]) == 0


def test_a_long_wait_is_announced(monkeypatch, caplog) -> None:
    monkeypatch.setattr(kernel_cache, "SILENT", 0.02)
    with caplog.at_level(logging.WARNING, logger="cdia_pin"):
        first_call("what is slow", [], lambda: time.sleep(0.2))
        first_call("what is quick", [], lambda: None)
    assert [m for m in caplog.messages if "what is slow" in m]
    assert not [m for m in caplog.messages if "what is quick" in m]


def test_generated_code_that_was_cut_off_is_written_again(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    effects, text = (CoulombFriction("joint1"),), "value = 1\n# the end\n"
    assert load(text, effects).value == 1
    (path,) = tmp_path.rglob("tick_*.py")
    path.write_text("valu")
    del sys.modules[path.stem]
    assert load(text, effects).value == 1
    assert path.read_text() == text
    del sys.modules[path.stem]
