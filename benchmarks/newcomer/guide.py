"""What a page of the documentation tells its reader to do, in its order."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

BLOCK = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NAMED_FILE = re.compile(r"`([\w.]+)`[^`\n]*:\s*$")  # the file that a block holds is named before it
REQUIREMENT = re.compile(r"cdia-pin(\[[\w,]+\])?")
PROMPT = "$ "  # before a command whose answer follows
NOT_RUN = "not-run"


@dataclass(frozen=True)
class Install:
    """A line that installs the package.

    Attributes:
        extras: In brackets, as pip takes them; empty for none.
    """

    extras: str


@dataclass(frozen=True)
class Command:
    """A line with ``cdia``.

    Attributes:
        words: What follows ``cdia``.
        answer: What the page says that it prints; empty if the page does not say.
    """

    words: tuple[str, ...]
    answer: str = ""

    @property
    def report(self) -> str:
        """The report that it writes; empty if it writes none."""
        return self.words[self.words.index("--report") + 1] if "--report" in self.words else ""

    def __str__(self) -> str:
        return shlex.join(("cdia", *self.words))


@dataclass(frozen=True)
class TextFile:
    """A file that the reader writes.

    Attributes:
        name: Its name.
        text: What is in it.
    """

    name: str
    text: str


Step = Install | Command | TextFile


def steps(page: Path) -> Iterator[Step]:
    """Yield what a page tells its reader to do.

    Args:
        page: The page, in Markdown.

    Raises:
        ValueError: If a line of a block of ``sh`` is neither of pip nor of cdia, and not marked as not to be run.
    """
    text = page.read_text(encoding="utf-8")
    for block in BLOCK.finditer(text):
        language, mark, body = block.groups()
        if language == "sh" and NOT_RUN not in mark:
            yield from (_step(line, page) for line in _lines(body))
        elif language == "json" and (named := NAMED_FILE.search(text[: block.start()])):
            yield TextFile(named.group(1), body)
        elif language == "text" and body.startswith(f"{PROMPT}cdia "):
            line, _, answer = body.partition("\n")
            yield Command(tuple(shlex.split(line.removeprefix(PROMPT))[1:]), answer)


def _lines(body: str) -> list[str]:
    return [line for line in body.replace("\\\n", " ").splitlines() if shlex.split(line, comments=True)]


def _step(line: str, page: Path) -> Step:
    program, *words = shlex.split(line, comments=True)
    if program == "cdia":
        return Command(tuple(words))
    named = REQUIREMENT.fullmatch(words[-1]) if words else None
    if (program, *words[:-1]) == ("pip", "install") and named:
        return Install(named.group(1) or "")
    raise ValueError(f"{page.name}: a newcomer cannot type '{line}' here")
