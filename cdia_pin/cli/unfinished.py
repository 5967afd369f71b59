"""What an interrupted command had found: kept beside the file of its result, and where the same command goes on."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self, TypedDict

from cdia_pin.cli.console import warn
from cdia_pin.errors import CdiaError
from cdia_pin.version import __version__

if TYPE_CHECKING:
    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import Log
    from cdia_pin.robot import RobotModel

SUFFIX = ".unfinished"


class Resumed(TypedDict):
    """Arguments of `discover` and `identify`: the model at which to begin, and what keeps each better one."""

    start: Dynamics | None
    keep: Callable[[Dynamics], None]


@dataclass(frozen=True)
class Unfinished:
    """The file of a command that has not ended.

    Attributes:
        path: The file; None if nothing is to be saved.
        key: Hash of the command, its logs and files: a run of anything else does not go on from here.
    """

    path: Path | None
    key: str

    @classmethod
    def beside(
        cls, save: Path | None, command: str, files: Sequence[Path | None] = (), logs: Sequence[Log] = ()
    ) -> Self:
        """Return what belongs to a command.

        Args:
            save: File of the result; None without one.
            command: What the user typed.
            files: What else the answer depends on, such as model, robot and gains; None where there is none.
            logs: The logs that are fitted.
        """
        digest = hashlib.sha256(f"{__version__} {command}".encode(errors="replace"))
        for file in files:
            digest.update(file.read_bytes() if file is not None and file.is_file() else b"")
        for log in logs:
            digest.update(log.sha256.encode())
        return cls(save and save.with_name(save.name + SUFFIX), digest.hexdigest())

    @contextmanager
    def told(self, goes_on: bool) -> Iterator[None]:
        """Say that the block goes on from the file, and where the file is if the block is interrupted again.

        Args:
            goes_on: Whether an interrupted run left something.
        """
        if goes_on:
            warn(f"going on from {self.path}, which an interrupted run left")
        try:
            yield
        except KeyboardInterrupt:
            if self.path is not None and self.path.is_file():
                warn(f"what was found so far is in {self.path}; the same command goes on from there")
            raise

    def forget(self) -> None:
        """Remove the file, because the result is written."""
        if self.path is not None:
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)


class UnfinishedSearch(Unfinished):
    """The last model of a search that has not ended."""

    def _read(self, robot: RobotModel) -> Dynamics | None:
        import json

        from cdia_pin.dynamics import load_model

        if self.path is None or not self.path.is_file():
            return None
        with contextlib.suppress(CdiaError, OSError, ValueError, KeyError, TypeError):
            if json.loads(self.path.read_text(encoding="utf-8"))["record"]["search"] == self.key:
                return load_model(self.path, robot)
        return None

    def keep(self, model: Dynamics) -> None:
        """Save a model that is better than those before; a full disk does not end the search.

        Args:
            model: The model.
        """
        from cdia_pin.dynamics import save_model

        if self.path is not None:
            with contextlib.suppress(CdiaError):
                save_model(model, self.path, record={"search": self.key})

    @contextmanager
    def resumed(self, robot: RobotModel) -> Iterator[Resumed]:
        """Give what an interrupted run left to the block.

        Args:
            robot: Whose model it is.
        """
        start = self._read(robot)
        with self.told(start is not None):
            yield {"start": start, "keep": self.keep}
