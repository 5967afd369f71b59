"""Reader of long, plain CSV text, a block of rows at a time. All other text is read whole."""

from __future__ import annotations

from pathlib import Path

from cdia_pin.logs.readers.arrow_batches import table_from_batches
from cdia_pin.logs.readers.csv import column_names
from cdia_pin.logs.readers.table import Table

BLOCK = 8 * 2**20  # [B], of text that is read at once
LONGEST_HEADER = 2**20  # [B], of the first line
# bytes of a plain text of numbers behind its header: neither quotes nor comments, no spaces between columns, no text
PLAIN = b"0123456789+-.eEnaifNAIF,;\t\r\n"


def read_long_csv(path: Path) -> Table | None:
    """Read CSV text that holds nothing but numbers below a line of names.

    Args:
        path: The file.

    Returns:
        The columns as numbers; None if the text is not as plain, so that it must be read whole.
    """
    import pyarrow as pa
    from pyarrow import csv

    header = _header(path)
    if header is None or not _is_plain(path, len(header)):
        return None
    names, delimiter = column_names(header.decode())
    if delimiter == ";" or any(not n for n in names):  # a semicolon may come with a decimal comma
        return None
    try:
        with csv.open_csv(
            path,
            read_options=csv.ReadOptions(
                column_names=names, skip_rows=1, block_size=BLOCK, use_threads=False
            ),
            parse_options=csv.ParseOptions(delimiter=delimiter),
        ) as reader:
            return table_from_batches(reader, reader.schema, path.name)
    except (pa.ArrowException, ValueError):  # what is wrong is told where the text is read whole
        return None


def _header(path: Path) -> bytes | None:
    """Return the first line with its end, None if it is not one of plain names."""
    with path.open("rb") as file:
        line = file.readline(LONGEST_HEADER)
    plain = line.isascii() and line.endswith(b"\n") and line.translate(None, PLAIN)
    return line if plain and not any(c in line for c in (b'"', b"#", b"\0", b"'")) else None


def _is_plain(path: Path, start: int) -> bool:
    """Tell whether the text behind the header has nothing but numbers, and ends with a line."""
    with path.open("rb") as file:
        file.seek(start)
        last = b""
        while block := file.read(BLOCK):
            if block.translate(None, PLAIN):
                return False
            last = block
    return last.endswith(b"\n")
