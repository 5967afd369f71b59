"""A newcomer: an environment of their own, a folder with a recording, and a page to follow."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.newcomer.guide import Command, Install, Step, TextFile

PATIENCE = 600.0  # [s], for one command
WIDTH = "80"  # characters of a terminal
NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?")
OWN = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")  # variables of whoever measures, which a newcomer lacks


class StoppedError(Exception):
    """A newcomer cannot go on; the message says at which step, and what was said there."""


@dataclass
class Newcomer:
    """Somebody who follows a page.

    Attributes:
        folder: Where they work; it holds a recording.
        wheel: What they install.
        installing: Time that it took [s].
        working: Time that the commands took [s].
        typed: The commands of cdia, in their order.
        reports: What was printed by the command that wrote a report, by the report.
        stopped: Why they could not go on; empty if they came to the end.
    """

    folder: Path
    wheel: Path
    installing: float = 0.0
    working: float = 0.0
    typed: list[Command] = field(default_factory=list)
    reports: dict[Path, str] = field(default_factory=dict)
    stopped: str = ""

    def follow(self, page: Iterable[Step]) -> None:
        """Do what a page says, until a command fails, or answers something else than the page says.

        Args:
            page: Its steps.
        """
        try:
            for step in page:
                self._do(step)
        except StoppedError as error:
            self.stopped = str(error)

    def _do(self, step: Step) -> None:
        match step:
            case Install():
                self._install(step)
            case TextFile():
                (self.folder / step.name).write_text(step.text, encoding="utf-8")
            case Command():
                self._type(step)

    @property
    def _environment(self) -> Path:
        return self.folder.parent / "environment"

    def _install(self, step: Install) -> None:
        begin = time.monotonic()
        python = self._environment / "bin" / "python"
        self._run([sys.executable, "-m", "venv", str(self._environment)])
        self._run([str(python), "-m", "pip", "install", "--quiet", f"{self.wheel}{step.extras}"])
        self.installing += time.monotonic() - begin

    def _type(self, step: Command) -> None:
        begin = time.monotonic()
        program = self._environment / "bin" / "cdia"
        printed = self._run([str(program), *step.words], answer=step.answer)
        self.working += time.monotonic() - begin
        self.typed.append(step)
        if step.report:
            self.reports[self.folder / step.report] = printed

    def _run(self, command: list[str], answer: str = "") -> str:
        """Run a program and return what it printed; it fails only where the page says with which words."""
        environment = {name: value for name, value in os.environ.items() if name not in OWN}
        done = subprocess.run(
            command,
            cwd=self.folder,
            env={**environment, "COLUMNS": WIDTH, "NO_COLOR": "1"},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        printed = done.stdout + done.stderr
        if answer and _words(answer) != _words(printed):
            raise StoppedError(f"{command}: the page says\n{answer}\nand the program\n{printed}")
        if done.returncode and not answer:
            raise StoppedError(f"{command}: {printed[-2000:]}")
        return done.stdout


def _words(text: str) -> list[str]:
    """Return the words of a text without its numbers, which differ from recording to recording."""
    return NUMBER.sub("0", text).split()
