"""Output files of a command: checked before the work, written after it, so that no result is lost."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.cli.console import close_stdout, warn
from cdia_pin.cli.failures import CommandError
from cdia_pin.extras import require
from cdia_pin.input_files import resolved
from cdia_pin.phrases import one_line
from cdia_pin.plain_json import plain
from cdia_pin.whole_files import require_place, write_whole

if TYPE_CHECKING:
    from rich.console import Console

STDOUT = "-"
BEGINNINGS = (b"", b"{", b"<")  # first byte of an empty file, of JSON, and of a page or a URDF
# characters that json leaves as they are and that control a terminal, turn its direction, or are no text at all
UNPRINTABLE = re.compile("[\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def require_writable(
    *files: str | Path | None, inputs: Iterable[str | Path] = (), tables: Sequence[str | Path | None] = ()
) -> None:
    """Refuse files that cannot be written, before time is spent on their contents.

    An option without its value takes the next word: ``--json run.csv other.csv`` would replace the first log by JSON.

    Args:
        *files: To be written; None and ``-`` are skipped. They replace no log.
        inputs: Files that must not be overwritten.
        tables: To be written as logs or other tables of numbers: they may replace one.

    Raises:
        CommandError: If a file cannot be written, is an input or a log, or is named twice.
    """
    read = {resolved(Path(p)) for p in inputs}
    seen: set[Path] = set()
    for file in (*files, *tables):
        if file is None or str(file) == STDOUT:
            continue
        path = Path(file)
        if path.exists() and not (path.is_file() or path.is_dir()):
            continue  # a pipe or a device takes what comes
        if resolved(path) in read:
            raise CommandError(f"{path} would be overwritten, but it is read from: give another name")
        if resolved(path) in seen:
            raise CommandError(f"{path} is named for two outputs: give each its own name")
        seen.add(resolved(path))
        _probe(path)
        if file not in tables and _is_log(path):
            raise CommandError(f"{path} would be overwritten, but it is a log: give another name")


def _is_log(path: Path) -> bool:
    """Tell whether a file is there that has the name of a log, and is not what a command wrote before."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        if file.read(1) in BEGINNINGS:
            return False
    from cdia_pin.logs.readers.dispatch import SUFFIXES

    return path.suffix.lower() in SUFFIXES


def _probe(path: Path) -> None:
    """Open a file for writing without changing what is there."""
    if path.is_dir():
        raise CommandError(f"cannot write {path}: it is a directory")
    try:
        require_place(path)
    except FileNotFoundError:
        raise CommandError(f"cannot write {path}: there is no directory {path.parent}") from None
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror}") from None


def require_report(report: Path | None) -> None:
    """Refuse a report that cannot be drawn here, before time is spent on its contents.

    Args:
        report: Its file; None without one.

    Raises:
        MissingExtraError: If a report is wanted and the extra ``view`` is not installed.
    """
    if report is not None:
        require("view", "reports")


def write_json(document: Mapping[str, object], file: str) -> None:
    """Write a document as JSON.

    Args:
        document: With its schema.
        file: Where; ``-`` is stdout.

    Raises:
        CommandError: If the file cannot be written.
    """
    text = json.dumps(plain(document), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    text = UNPRINTABLE.sub(lambda found: f"\\u{ord(found[0]):04x}", text)
    if file == STDOUT:
        try:
            sys.stdout.write(text)
            sys.stdout.flush()
        except BrokenPipeError:
            close_stdout()
        return
    write_document(text, file)


def write_document(text: str, file: str) -> None:
    """Write a text.

    Args:
        text: The text.
        file: Where.

    Raises:
        CommandError: If the file cannot be written.
    """
    try:
        write_whole(file, text)
    except OSError as error:
        raise CommandError(f"cannot write {file}: {error.strerror}") from None


def write_all(console: Console, *writers: tuple[str | Path | None, Callable[[str], object]]) -> None:
    """Write every output that was asked for, even if another one fails, and name the files.

    Args:
        console: Where the files are named.
        *writers: A file, or None, with the function that writes it.

    Raises:
        Exception: The first failure, after all others were written.
    """
    failure = None
    for file, write in writers:
        if file is None:
            continue
        try:
            write(str(file))
        except Exception as error:
            if failure:
                warn(one_line(error))
            failure = failure or error
            continue
        if str(file) != STDOUT:
            console.print(f"wrote {file}", markup=False, soft_wrap=True)
    if failure:
        raise failure
