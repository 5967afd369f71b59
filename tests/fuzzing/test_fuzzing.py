"""Files that were damaged at random are read or refused in one line: every kind of input, from a corpus.

``CDIA_FUZZ=50 python -m pytest tests/fuzzing`` tries 50 times as many; `guided.py` looks for inputs that
reach new code. What breaks is put into the corpus, named ``broke_…``.
"""

from __future__ import annotations

import os
import re
import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cdia_pin.errors import CdiaError
from tests.fuzzing.readers import CORPUS, READERS, monitored

EXAMPLES = 60 * int(os.environ.get("CDIA_FUZZ", "1"))
# what often breaks a parser, beside single bytes
TOKENS = (
    *(
        b"nan",
        b"inf",
        b"-inf",
        b"1e400",
        b"-1e308",
        b"9" * 400,
        b"0x10",
        b"1_000",
        b"true",
        b"null",
        b"{}",
        b"[]",
    ),
    *(
        b'"',
        b"'",
        b"\0",
        b"\n",
        b"\r\n",
        b",",
        b";",
        b"\t",
        b"#",
        b"<",
        b">",
        b"&",
        b"{",
        b"[",
        b"=",
        b":",
        b"@",
    ),
    *(
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\x1b[2J",
        b"\xe2\x80\xae",
        b"time",
        b"position",
        b"joint1",
        b" " * 3000,
    ),
)


@st.composite
def damaged(draw: st.DrawFn, kind: str) -> tuple[str, bytes]:
    """The suffix and the bytes of a file of the corpus, with up to six changes."""
    file = draw(st.sampled_from(sorted((CORPUS / kind).iterdir())))
    data = file.read_bytes()
    for _ in range(draw(st.integers(0, 6))):
        start = draw(st.integers(0, len(data)))
        stop = min(len(data), start + draw(st.integers(0, 40)))
        change = draw(st.sampled_from(["flip", "delete", "token", "repeat", "cut", "bytes"]))
        if change == "flip" and start < len(data):
            data = data[:start] + bytes([data[start] ^ draw(st.integers(1, 255))]) + data[start + 1 :]
        elif change == "delete":
            data = data[:start] + data[stop:]
        elif change == "token":
            data = data[:start] + draw(st.sampled_from(TOKENS)) + data[stop:]
        elif change == "repeat":
            data = data[:stop] + data[start:stop] * draw(st.integers(1, 3)) + data[stop:]
        elif change == "cut":
            data = data[:start]
        elif change == "bytes":
            data = data[:start] + draw(st.binary(max_size=20)) + data[start:]
    return file.suffix, data


def test_every_kind_has_a_corpus():
    assert {folder.name for folder in CORPUS.iterdir()} == set(READERS)


def test_the_samples_of_the_corpus_make_the_monitor_correct():
    added = [
        abs(command - nominal).max() for _, nominal, command in monitored(CORPUS / "samples" / "plain.f64")
    ]
    assert max(added[:30]) == 0.0 and max(added) > 1.0


@pytest.mark.parametrize("kind", READERS)
def test_what_is_not_damaged_is_read(kind, tmp_path):
    for file in sorted((CORPUS / kind).iterdir()):
        if not file.name.startswith("broke_"):
            READERS[kind](file)


def read_or_refuse(kind, file):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            READERS[kind](file)
        except CdiaError as error:
            assert str(error).strip()
            assert not re.search(r"Traceback \(most recent", str(error))


@pytest.mark.parametrize("file", sorted(CORPUS.glob("*/broke_*")), ids=lambda file: file.name)
def test_what_broke_once_is_read_or_refused(file):
    read_or_refuse(file.parent.name, file)


@pytest.mark.parametrize("kind", READERS)
@given(data=st.data())
@settings(
    max_examples=EXAMPLES,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
def test_what_is_damaged_is_read_or_refused(kind, tmp_path, data):
    suffix, content = data.draw(damaged(kind))
    file = tmp_path / f"damaged{suffix}"
    file.write_bytes(content)
    read_or_refuse(kind, file)
