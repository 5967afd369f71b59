"""Parts of a page in Markdown."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Sequence
from pathlib import Path

Row = Sequence[object]


def table(heads: Sequence[str], rows: Iterable[Row]) -> str:
    """Return a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(str(c).replace("|", "\\|") for c in line) + " |" for line in lines)


def details(title: str, body: str) -> str:
    """Return a part that opens when asked to."""
    return f"<details><summary>{title}</summary>\n\n{body}\n\n</details>"


def processor() -> str:
    """Return the processor's name, where the system tells it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
