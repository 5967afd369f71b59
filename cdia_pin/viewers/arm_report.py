"""The study of accommodation on several arms, as a table and as one HTML file."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.campaigns.arm_study import SETTLED
from cdia_pin.errors import CdiaError
from cdia_pin.viewers.study_figures import Picture
from cdia_pin.viewers.study_report import PAGE, figure_blocks, page_style
from cdia_pin.viewers.words import number, percent
from cdia_pin.whole_files import write_whole

if TYPE_CHECKING:
    from cdia_pin.campaigns.arm_study import ArmCase
    from cdia_pin.campaigns.closed_loop import LoopSettings

TITLE = "Accommodation on several arms"


def arm_rows(cases: Sequence[ArmCase]) -> list[tuple[str, ...]]:
    """Return a line for each case: arm, fault, tracking healthy, faulty and accommodated, ratio, isolated faults.

    Tracking is the RMS over all joints [mrad]; no joint slides. The ratio is that of the worst joint.

    Args:
        cases: Of `arm_study`.
    """
    rows = []
    for case in cases:
        rms = case.tracking()
        right, there = case.named()
        whole = (_milli(np.sqrt(np.mean(x**2))) for x in rms.values())
        worst = float(np.max(rms["accommodated"] / rms["healthy"]))
        wrong = len(case.wrong())
        named = f"{right} of {there}" + (f", {wrong} wrong" if wrong else "")
        rows.append((case.arm, case.name, *whole, f"{number(worst)} ×", named))
    return rows


HEADINGS = ("arm", "fault", "healthy", "faulty", "accommodated", "worst joint", "isolated")


def write_arm_report(
    path: str | Path,
    rows: Sequence[Sequence[str]],
    settings: LoopSettings,
    pictures: Sequence[Picture],
    command: str = "",
) -> Path:
    """Write what the study measured as one HTML page that needs no network.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        rows: Of `arm_rows`.
        settings: Of the closed loops.
        pictures: Of `arm_pictures`.
        command: What made the report, to be shown.

    Raises:
        CdiaError: If the file cannot be written.
    """
    head = "".join(f"<th{' class=n' if 2 <= k < 6 else ''}>{h}</th>" for k, h in enumerate(HEADINGS))
    body = "".join(
        "<tr>"
        + "".join(f"<td{' class=n' if 2 <= k < 6 else ''}>{html.escape(c)}</td>" for k, c in enumerate(row))
        + "</tr>"
        for row in rows
    )
    parts = [
        "<p class='lead'>Computed torque follows an exciting motion; faults begin on all joints at once. The "
        f"model's inertias are wrong by up to {percent(settings.model_error)}, positions are rounded, velocities and "
        f"torques noisy. The monitor has learned from {settings.healthy_runs} healthy runs of "
        f"{settings.healthy_duration:g} s on other motions.</p>",
        f"<pre><code>{html.escape(command)}</code></pre>" if command else "",
        "<h2>Tracking</h2>",
        f"<p class='soft'>RMS of q − q_d over all joints [mrad], from {SETTLED:g} s after the last fault began. "
        "Worst joint: accommodated over healthy, where that is largest. Isolated: faults named at the end, of "
        "those that were present.</p>",
        f"<div class='card scroll'><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>",
        "<h2>Joint by joint</h2>",
        *figure_blocks(pictures),
    ]
    page = PAGE.format(title=TITLE, style=page_style(), body="\n".join(parts))
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, page)
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None
    return path


def _milli(value: float) -> str:
    return number(1e3 * value) if np.isfinite(value) else "diverged"
