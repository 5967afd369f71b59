"""Where outcomes of the present text are kept."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from benchmarks.outcomes import CHECKOUT, Kept, Store, package_text, text_hash

STORE = CHECKOUT / ".cache" / "real-residuals"
APART = (  # files that no outcome depends on
    "__main__.py",
    "running.py",
    "claims.py",
    "judging.py",
    "known_truths.py",
    "options.py",
    "page.py",
    "stability.py",
    "tables.py",
)
WITHOUT = (
    "cli",
    "viewers",
    "app",
    "campaigns",
    "cluster",
    "diagnosis",
)  # parts of the package that no outcome needs

O = TypeVar("O", bound=Kept)  # noqa: E741


def texts() -> list[Path]:
    """Return the files on which outcomes depend: of the package, and of what is drawn and put into logs."""
    return [*package_text(WITHOUT), *(f for f in Path(__file__).parent.glob("*.py") if f.name not in APART)]


def store_of(kind: str, read_line: Callable[[str], O], folder: Path = STORE) -> Store[O]:
    """Return where outcomes of the present text are kept.

    Args:
        kind: What they are of.
        read_line: From a line to an outcome.
        folder: Where files are kept.
    """
    return Store(folder / f"{kind}-{text_hash(texts())}.jsonl", read_line)
