"""Runs kept on disk, found again by everything that determines them, the plant's own source included."""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

MOST = 300  # runs kept; one of 36 s at 250 Hz takes 2.6 MB
HOME = Path(__file__).resolve().parents[2] / ".cache" / "plant"


@cache
def source_hash() -> str:
    """Return a hash of this package's source and of MuJoCo's version: a changed plant runs anew."""
    h = hashlib.sha256(mujoco.__version__.encode())
    for file in sorted(Path(__file__).parent.rglob("*.py")):
        if file.name not in {"scenarios.py", "sizes.py", "cache.py", "noise.py"}:
            h.update(file.read_bytes())
    return h.hexdigest()


def key(*determines: object) -> str:
    """Return a name for a run from what determines it; each must have a faithful repr."""
    return hashlib.sha256(repr((source_hash(), *determines)).encode()).hexdigest()[:32]


def load(name: str) -> dict[str, NDArray[np.float64]] | None:
    """Return the arrays kept under a name, or None."""
    try:
        kept = HOME / f"{name}.npz"
        with np.load(kept, allow_pickle=False) as file:
            kept.touch()
            return {k: file[k] for k in file.files}
    except (OSError, ValueError, EOFError):
        return None


def save(name: str, arrays: dict[str, NDArray[np.float64]]) -> None:
    """Keep arrays under a name; a reader sees all of them or none."""
    HOME.mkdir(parents=True, exist_ok=True)
    (HOME.parent / ".gitignore").write_text("*\n", encoding="utf-8")
    handle, part = tempfile.mkstemp(dir=HOME, suffix=".part")
    with os.fdopen(handle, "wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
    Path(part).replace(HOME / f"{name}.npz")
    by_age = sorted(HOME.glob("*.npz"), key=_last_used)
    for old in by_age[:-MOST]:
        old.unlink(missing_ok=True)


def _last_used(file: Path) -> float:
    try:
        return file.stat().st_mtime
    except OSError:  # another process removed it
        return 0.0
