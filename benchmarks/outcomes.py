"""Outcomes of cases as JSON lines, so that an interrupted run goes on where it was, and pages need no run."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, Self, TypeVar

CHECKOUT = Path(__file__).resolve().parents[1]


def environment_of(checkout: Path) -> dict[str, str]:
    """Return the environment of a program that runs with the package of a checkout, on one thread.

    Args:
        checkout: Its folder.
    """
    return os.environ | {"PYTHONPATH": str(checkout), "OPENBLAS_NUM_THREADS": "1"}


class Kept(Protocol):
    """What can be kept: it has a name, and is a line."""

    @property
    def id(self) -> str:
        """Name of the case."""

    def to_json(self) -> str:
        """Return the outcome as a line of JSON."""


class JsonLine:
    """Base of outcomes that are dataclasses: each is a line of JSON.

    Attributes:
        READ: From plain JSON to the values of those fields that are not plain, by field.
    """

    READ: ClassVar[Mapping[str, Callable[[Any], object]]] = {}

    def to_json(self) -> str:
        """Return the outcome as a line of JSON."""
        return json.dumps(asdict(self), ensure_ascii=False)  # type: ignore[call-overload]

    @classmethod
    def from_json(cls, line: str) -> Self:
        """Read back what `to_json` wrote."""
        given = json.loads(line)
        return cls(**{name: cls.READ.get(name, lambda v: v)(value) for name, value in given.items()})


T = TypeVar("T", bound=Kept)


class Store(Generic[T]):
    """Outcomes in a file, one a line.

    Args:
        path: The file.
        read_line: From a line to an outcome.
    """

    def __init__(self, path: Path, read_line: Callable[[str], T]) -> None:
        self.path, self._read_line = path, read_line

    def read(self) -> dict[str, T]:
        """Return what is there, by the case's name; a line cut short by an interruption is left out."""
        if not self.path.exists():
            return {}
        lines = self.path.read_text(encoding="utf-8").splitlines()
        whole = [self._read_line(line) for line in lines if line.endswith("}")]
        return {o.id: o for o in whole}

    def add(self, outcome: T) -> None:
        """Append an outcome, on a line of its own even behind one that was cut short."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab+") as file:
            if file.tell():
                file.seek(-1, os.SEEK_END)
                if file.read() != b"\n":
                    file.write(b"\n")
            file.write(outcome.to_json().encode() + b"\n")

    def forget(self) -> None:
        """Delete what is there."""
        self.path.unlink(missing_ok=True)


def text_hash(files: Iterable[Path]) -> str:
    """Return a hash of the names and the text of files of the checkout."""
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.relative_to(CHECKOUT).as_posix().encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def package_text(without: Iterable[str]) -> list[Path]:
    """Return the files of the package, less those of some of its parts, and those of the plant."""
    apart = {CHECKOUT / "cdia_pin" / part for part in without}
    files = [f for f in (CHECKOUT / "cdia_pin").rglob("*.py") if not apart & set(f.parents)]
    return [*files, *(CHECKOUT / "benchmarks" / "plant").rglob("*.py")]


def tell(line: str) -> None:
    """Print a line about progress."""
    print(line, file=sys.stderr, flush=True)
