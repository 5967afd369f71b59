"""Results on stdout, warnings and progress on stderr."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from cdia_pin.phrases import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

Tell = Callable[[str, float], None]
_RUNNING: list[Progress] = []  # bars on the terminal


def stdout(json: str | None = None) -> Console:
    """Return the console for results.

    If a reader closes the pipe (``| head``), the console becomes silent; the command goes on and writes its files.

    Args:
        json: Value of the option ``--json``; with ``-`` stdout carries JSON and the console is silent.
    """
    return _console(quiet=json == "-")


def _console(*, quiet: bool = False, stderr: bool = False) -> Console:
    """Return a console that prints no character of a file that controls the terminal."""
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.segment import Segment

    class Results(Console):
        def render(
            self, renderable: RenderableType, options: ConsoleOptions | None = None
        ) -> Iterator[Segment]:
            for segment in super().render(renderable, options):
                plain = segment.control or segment.text.isprintable()
                yield segment if plain else segment._replace(text=printable(segment.text, also="\n"))

        def on_broken_pipe(self) -> None:
            self.quiet = True
            close_stdout()

    return Results(highlight=False, emoji=False, quiet=quiet, stderr=stderr)


def close_stdout() -> None:
    """Send what is still to be printed nowhere, once the reader of stdout is gone."""
    with contextlib.suppress(OSError, ValueError):  # a stream without a file, as tests have
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def warn(message: str) -> None:
    """Print one line on stderr.

    Args:
        message: The warning.
    """
    print(f"cdia: warning: {printable(' '.join(message.split()))}", file=sys.stderr)


@contextmanager
def progress() -> Iterator[Tell]:
    """Give a function that shows a sentence and the share done, on stderr and only on a terminal."""
    if not sys.stderr.isatty():
        yield lambda sentence, share: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = _console(stderr=True)
    columns = (BarColumn(24), TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=None)  # moves to and fro until a share is known

        def tell(sentence: str, share: float) -> None:
            done = max(share, bar.tasks[0].completed)  # never back
            bar.update(task, description=sentence, completed=done, total=1.0 if done else None)

        _RUNNING.append(bar)
        try:
            yield tell
        finally:
            _RUNNING.remove(bar)


@contextmanager
def paused() -> Iterator[Console]:
    """Give the console of stderr for questions, while no bar moves."""
    bars = list(_RUNNING)
    for bar in bars:
        bar.stop()
    try:
        yield _console(stderr=True)
    finally:
        for bar in bars:
            bar.start()
