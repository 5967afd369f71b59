"""Reader of CSV: comma, semicolon, tab or space between columns, ``#`` comments, any line ending."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import sort_names
from cdia_pin.logs.readers.arrow import table_from_arrow
from cdia_pin.logs.readers.missing_header import header_advice
from cdia_pin.logs.readers.table import Table
from cdia_pin.phrases import LONGEST_REASON, one_line

if TYPE_CHECKING:
    import pyarrow as pa

_BOMS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_COMMENT = re.compile(rb"(?m)^[ \t]*#[^\r\n]*(?:\r\n|\r|\n|$)")
_CUT_NUMBER = re.compile(r"^(?:[+-]?[0-9.,]*(?:[eE][+-]?)?)$")
_QUOTED = re.compile(r'"[^"]*"')
_DECIMAL_COMMA = re.compile(r"^-?\d+,\d+$")


def read_csv(data: bytes, source: str, joints: Sequence[str] = ()) -> Table:
    """Read CSV text with a header line.

    Args:
        data: Bytes of the file.
        source: Its name, for messages.
        joints: Joints of the robot, for the line of names that a table may lack.

    Returns:
        The columns as numbers.

    Raises:
        LogError: If it is empty, not text, has no header or rows of different lengths.
    """
    text, notes = _plain_text(data, source)
    _refuse_stray_quotes(text, source)
    header, text = _header(text, source, notes)
    names, delimiter = column_names(header)
    if delimiter == " ":
        text = re.sub(rb"(?m)^ | (?=\r?$)", b"", re.sub(rb"[ \t]+", b" ", text))  # each in one pass
    if all(_is_number(n) for n in names):
        raise LogError(
            f"{source}: the first line holds numbers, expected column names; "
            f"{header_advice(len(names), joints, delimiter)}"
        )
    if not text.strip():
        raise LogError(f"{source}: a header line but no samples")
    text = _without_cut_row(text, delimiter, notes)
    arrow = _parse(text, names, delimiter, source, notes)
    return table_from_arrow(arrow, source, tuple(notes))


def column_names(header: str) -> tuple[list[str], str]:
    """Return the names in the line of a header, and the delimiter between them.

    Args:
        header: The line.
    """
    delimiter = _delimiter(header)
    names = [_without_quotes(cell.strip()) for cell in _cells(header.strip(), delimiter)]
    return [n for n in names if n] if delimiter == " " else names, delimiter


def _cells(line: str, delimiter: str) -> list[str]:
    """Split a line at the delimiters that are not between quotes."""
    cells: list[list[str]] = []
    is_open = False
    for piece in line.split(delimiter):
        if is_open:
            cells[-1].append(piece)
        else:
            cells.append([piece])
        is_open ^= piece.count('"') % 2 == 1
    return [delimiter.join(pieces) for pieces in cells]


def _without_quotes(name: str) -> str:
    if len(name) > 1 and name.startswith('"') and name.endswith('"'):
        return name[1:-1].replace('""', '"').strip()
    return name.strip("\"'").strip()


def _plain_text(data: bytes, source: str) -> tuple[bytes, list[str]]:
    """Return the bytes as UTF-8 without a byte order mark."""
    for mark, encoding in _BOMS:
        if data.startswith(mark):
            try:
                data = data[len(mark) :] if encoding == "utf-8" else data.decode(encoding).encode()
            except UnicodeDecodeError as error:
                raise LogError(f"{source}: not readable as {encoding} text ({error.reason})") from None
    if b"\0" in data[:4096]:
        raise LogError(f"{source}: holds binary data, expected CSV text")
    if not data.strip():
        raise LogError(f"{source}: the file is empty")
    return data, []


def _refuse_stray_quotes(data: bytes, source: str) -> None:
    """Refuse a line with an odd number of quotes, which would swallow the lines after it."""
    if b'"' not in data:
        return
    for number, line in enumerate(data.splitlines(), 1):
        if line.count(b'"') % 2 and not line.lstrip().startswith(b"#"):
            said = line[:60].decode(errors="replace")
            raise LogError(f"{source}: line {number} has a quotation mark without its partner: {said}")


def _without_cut_row(text: bytes, delimiter: str, notes: list[str]) -> bytes:
    """Leave out a last row that ends in the middle; say so where it may end in the middle of a number."""
    if text.endswith((b"\n", b"\r")):
        return text
    start = max(text.rfind(b"\n"), text.rfind(b"\r")) + 1
    last = text[start:].decode(errors="replace").split(delimiter)[-1].strip().strip("\"'")
    if start and not _is_number(last.replace(",", ".")) and _CUT_NUMBER.match(last):
        notes.append("the last row is cut off and was left out")
        return text[:start]
    notes.append("the last line has no end: if the file was cut off, its last value is wrong")
    return text


def _header(data: bytes, source: str, notes: list[str]) -> tuple[str, bytes]:
    """Split off the line of column names, which may be the last comment (numpy.savetxt)."""
    comments: list[bytes] = []
    if b"#" in data:
        comments = [c.strip().lstrip(b"#").strip() for c in _COMMENT.findall(data)]
        data = _COMMENT.sub(b"", data)
    data = data.lstrip(b"\r\n \t")
    first, rest = _first_line(data)
    try:
        header = first.decode()
        if not rest.isascii():
            rest.decode()  # pyarrow would print a traceback for an invalid row that is not UTF-8
    except UnicodeDecodeError:
        raise LogError(f"{source}: not readable as UTF-8 text") from None
    commented = [c.decode(errors="replace") for c in comments]
    values = header.strip().split(_delimiter(header))
    if all(_is_number(v.replace(",", ".")) for v in values if v):
        for comment in reversed(commented):
            names = [n.strip() for n in comment.split(_delimiter(comment)) if n.strip()]
            if len(names) > 1 and sort_names(names).time:
                notes.append("column names taken from the commented header line")
                return comment, data
    return header, rest


def _first_line(data: bytes) -> tuple[bytes, bytes]:
    ends = [i for i in (data.find(b"\n"), data.find(b"\r")) if i >= 0]
    if not ends:
        return data, b""
    return data[: min(ends)], data[min(ends) :].lstrip(b"\r\n")


def _delimiter(header: str) -> str:
    bare = _QUOTED.sub("", header)
    counts = {d: bare.count(d) for d in (",", ";", "\t")}
    best = max(counts, key=lambda d: counts[d])
    return best if counts[best] else " "


def _parse(text: bytes, names: list[str], delimiter: str, source: str, notes: list[str]) -> pa.Table:
    import pyarrow as pa
    from pyarrow import csv

    broken: list[tuple[int, str]] = []

    def remember(row: csv.InvalidRow) -> str:
        broken.append((row.actual_columns, row.text or ""))
        return "skip"

    decimal_point = "."
    if delimiter == ";" and any(_DECIMAL_COMMA.match(v.strip()) for v in _sample_values(text)):
        decimal_point = ","
        notes.append("numbers read with a decimal comma")
    try:
        table = csv.read_csv(
            pa.BufferReader(text),
            read_options=csv.ReadOptions(column_names=names),
            parse_options=csv.ParseOptions(delimiter=delimiter, invalid_row_handler=remember),
            convert_options=csv.ConvertOptions(decimal_point=decimal_point),
        )
    except (pa.ArrowException, ValueError) as error:
        raise LogError(
            f"{source}: not readable as CSV with {len(names)} columns ({one_line(error, LONGEST_REASON)})"
        ) from None
    cut = text.rstrip().endswith(broken[0][1].strip().encode()) if len(broken) == 1 else False
    if broken and not (cut and broken[0][0] < len(names)):
        count, example = broken[0]
        raise LogError(
            f"{source}: rows that do not have the {len(names)} columns of the header: {len(broken)}; "
            f"one has {count}: '{example[:60]}'"
        )
    if broken:
        notes.append("the last row is cut off and was left out")
    return table


def _sample_values(text: bytes) -> list[str]:
    return _first_line(text)[0].decode(errors="replace").split(";")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
