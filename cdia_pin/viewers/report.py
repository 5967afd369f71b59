"""Write a report: one HTML file that opens from disk, without network, years from now."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from cdia_pin.errors import CdiaError
from cdia_pin.viewers.report_data import report_data

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison, Discovery
    from cdia_pin.logs import LogCheck

LARGEST = 3_000_000  # bytes
POINTS = (2000, 1000, 500, 250, 100)  # samples of a curve, the most that fits


def write_report(
    path: str | Path,
    comparison: Comparison,
    *,
    improved: Comparison | None = None,
    discovery: Discovery | None = None,
    checks: Sequence[LogCheck] = (),
    title: str = "",
    command: str = "",
) -> Path:
    """Write what was found as one HTML page of at most 3 MB.

    The page needs no network and its own policy forbids any. The same results give the same bytes.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        comparison: The model as given against the logs, ``compare(model, logs)``.
        improved: The improved model against the same logs, ``compare(discovery.model, logs)``.
        discovery: The outcome of ``discover``, where there was one.
        checks: What ``check_log`` said about each log.
        title: Headline; made from the robot if empty.
        command: The command that made the report, to be shown.

    Returns:
        The path of the page.

    Raises:
        CdiaError: If the results do not belong together, or the file cannot be written.
    """
    page = b""
    for points in POINTS:
        page = _page(
            report_data(comparison, improved, discovery, checks, title=title, command=command, points=points)
        )
        if len(page) <= LARGEST:
            break
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(page)
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None
    return path


def _page(data: dict[str, Any]) -> bytes:
    sentences = data["discovery"]["sentences"] if data["discovery"] else []
    page = Template(_asset("report.html")).substitute(
        title=html.escape(data["title"]),
        summary=html.escape(" ".join(sentences)),
        licence=_asset("uPlot.LICENSE"),
        uplot_style=_asset("uPlot.min.css"),
        uplot=_asset("uPlot.iife.min.js"),
        data=embeddable(data),
        script=_asset("report.js"),
    )
    return page.encode("utf-8", errors="replace")


def embeddable(data: Any) -> str:
    """Return JSON that no text inside it can end early: ``<``, ``>`` and ``&`` are escaped."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _asset(name: str) -> str:
    return (files("cdia_pin.viewers") / "assets" / name).read_text(encoding="utf-8")
