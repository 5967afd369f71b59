"""Work that crashes is said with a way on and logged; the page goes on."""

import asyncio
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui")

from cdia_pin.app.runner import Runner


@pytest.fixture
def runner():
    made = Runner.__new__(Runner)
    made.job = None
    element = lambda: SimpleNamespace(text="", props={}, update=lambda: None)  # noqa: E731
    made.said, made.wrong, made.bar, made._sentence, made._share = (element() for _ in range(5))
    return made


class PanicException(BaseException):
    """What a panic of Rust becomes."""


@pytest.mark.parametrize("error", [RuntimeError("odd"), PanicException("index")])
def test_a_crash_is_said_and_logged(runner, monkeypatch, tmp_path, error):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def work(tell):
        raise error

    assert asyncio.run(runner.run("Searching", work)) is None
    (file,) = tmp_path.glob("cdia-error-*.txt")
    assert str(file) in runner.wrong.text and "go on" in runner.wrong.text
    assert "Searching" in file.read_text() and "Traceback" in file.read_text()
    assert asyncio.run(runner.run("Searching", lambda tell: 7)) == 7
