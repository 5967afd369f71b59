"""The report of a campaign: one HTML file."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.errors import CdiaError
from cdia_pin.viewers.curve import Curve, curve_picture
from cdia_pin.viewers.study_report import PAGE, page_style
from cdia_pin.viewers.text_campaign import (
    MEANING,
    campaign_answer,
    campaign_rows,
    names_rows,
    worst_rows,
)
from cdia_pin.whole_files import write_whole

if TYPE_CHECKING:
    from cdia_pin.campaigns.campaign_result import CampaignResult

TITLE = "Campaign of a monitor"
TEXT_COLUMNS = ("settings", "robot", "fault", "hidden", "believed at the end", "what is wrong", "again")


def write_campaign_report(path: str | Path, found: CampaignResult, folder: str, command: str = "") -> Path:
    """Write what a campaign measured as one HTML page that needs no network.

    Args:
        path: Where to write; an existing file is replaced.
        found: The result.
        folder: Of the campaign, for the commands that make runs again.
        command: What made the report, to be shown.

    Raises:
        CdiaError: If the file cannot be written.
    """
    try:
        return write_whole(path, campaign_page(found, folder, command))
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None


def campaign_page(found: CampaignResult, folder: str, command: str = "") -> str:
    """Return the page.

    Args:
        found: The result.
        folder: Of the campaign.
        command: What made the report.
    """
    body = [
        *(f"<p class='lead'>{html.escape(sentence)}</p>" for sentence in campaign_answer(found)),
        f"<pre><code>{html.escape(command)}</code></pre>" if command else "",
        "<h2>Combinations</h2>",
        f"<p class='soft'>{html.escape(MEANING)}</p>",
        html_table(*campaign_rows(found)),
        "<h2>Threshold against false alarms</h2>",
        "<p class='soft'>What the threshold alone would do with another level, from the residuals of the same runs. "
        "The detector of faults that last has no part in it. The ring is the monitor as it is.</p>",
        curve_picture(_curves(found), "false alarms an hour", "share of the faults that cross it"),
        "<h2>Names</h2>",
        html_table(("hidden", "believed at the end", "runs"), names_rows(found)),
    ]
    if found.worst:
        heads = ("run", "hidden", "what is wrong", "again")
        body += ["<h2>Worst runs</h2>", html_table(heads, worst_rows(found, folder))]
    return PAGE.format(title=TITLE, style=page_style(), body="\n".join(body))


def _curves(found: CampaignResult) -> list[Curve]:
    out = []
    for settings, points in found.operating_points.items():
        xy = tuple((p.false_alarms.value, p.detected.value) for p in points)
        now = min(range(len(points)), key=lambda k: abs(points[k].factor - 1.0)) if points else 0
        out.append(Curve(settings or "defaults", xy, now))
    return out


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return rows as a table.

    Args:
        heads: Headings.
        rows: Cells.
    """
    kind = ["" if h in TEXT_COLUMNS else " class='n'" for h in heads]
    head = "".join(f"<th{k}>{html.escape(h)}</th>" for k, h in zip(kind, heads, strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td{k}>{html.escape(c)}</td>" for k, c in zip(kind, row, strict=True)) + "</tr>"
        for row in rows
    )
    return (
        f"<div class='card scroll'><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )
