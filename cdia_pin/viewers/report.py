"""The report of a comparison or a discovery."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.viewers.change_words import changes_sentence
from cdia_pin.viewers.page import write_page
from cdia_pin.viewers.report_data import report_data, require_same
from cdia_pin.viewers.report_scene import scene_of_comparison
from cdia_pin.viewers.verdict import verdict_sentences

if TYPE_CHECKING:
    from cdia_pin.changes import Changes
    from cdia_pin.discovery import Comparison, Discovery
    from cdia_pin.logs import LogCheck


def write_report(
    path: str | Path,
    comparison: Comparison,
    *,
    improved: Comparison | None = None,
    discovery: Discovery | None = None,
    checks: Sequence[LogCheck] = (),
    changes: Sequence[Changes] = (),
    by_log: Sequence[Comparison] = (),
    title: str = "",
    command: str = "",
) -> Path:
    """Write a comparison, and a discovery if there is one, as one HTML page of at most 6 MB.

    The page needs no network, and its own policy forbids any. The same results give the same bytes.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        comparison: The model as given against the logs, ``compare(model, logs)``.
        improved: The improved model against the same logs, ``compare(discovery.model, logs)``.
        discovery: The outcome of ``discover``; None without one.
        checks: The outcome of ``check_log`` for each log.
        changes: The outcome of ``changes_between``; empty without several logs.
        by_log: The model as given against each of several logs.
        title: Headline; made from the robot if empty.
        command: The command that made the report, to be shown.

    Returns:
        The path of the page.

    Raises:
        CdiaError: If the results do not belong together, or the file cannot be written.
        MissingExtraError: If the extra ``view`` is not installed.
    """
    require_same(comparison, improved, discovery)
    return write_page(
        path,
        lambda points: report_data(
            comparison,
            improved,
            discovery,
            checks,
            changes=changes,
            by_log=by_log,
            title=title,
            command=command,
            points=points,
        ),
        scene_of_comparison(comparison, improved, discovery),
        "report.js",
        verdict_sentences(discovery) if discovery else tuple(changes_sentence(c) for c in changes),
    )
