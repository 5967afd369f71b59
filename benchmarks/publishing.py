"""A page of results: the command that it is made by, and the file that it goes to."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Sequence
from pathlib import Path

from benchmarks.outcomes import tell
from cdia_pin.whole_files import write_whole


def stated(parser: argparse.ArgumentParser, options: argparse.Namespace, deciding: Sequence[str]) -> str:
    """Return the command for a reader to repeat, without what is only of this machine or this run.

    Args:
        parser: Of the command.
        options: What it was given.
        deciding: Names of the options that decide what is on the page; the others are left out.
    """
    words = [parser.prog]
    for name in deciding:
        given = getattr(options, name)
        if given == parser.get_default(name):
            continue
        words.append(f"--{name}")
        if given is not True:
            words += (shlex.quote(str(word)) for word in (given if isinstance(given, list) else [given]))
    return " ".join(words)


def publish(text: str, path: Path | None) -> None:
    """Write a page, or print it where there is no file for it."""
    if path is None:
        print(text)
        return
    write_whole(path, text)
    tell(f"wrote {path}")
