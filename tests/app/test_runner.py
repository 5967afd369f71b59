"""Work that crashes is said with a way on and logged; the page goes on."""

import asyncio

import pytest

from cdia_pin.app.runner import Runner


class PanicException(BaseException):
    """What a panic of Rust becomes."""


@pytest.mark.parametrize("error", [RuntimeError("odd"), PanicException("index")])
def test_a_crash_is_said_and_logged(monkeypatch, tmp_path, error):
    runner = Runner()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def work(tell):
        raise error

    assert asyncio.run(runner.run("Searching", work)) is None
    (file,) = tmp_path.glob("cdia-error-*.txt")
    assert str(file) in runner.wrong and "go on" in runner.wrong
    assert "Searching" in file.read_text() and "Traceback" in file.read_text()
    assert asyncio.run(runner.run("Searching", lambda tell: 7)) == 7
