"""A campaign in the terminal: the short answer, a line for each combination, names, and the worst runs."""

from __future__ import annotations

from math import inf, isfinite, isnan
from typing import TYPE_CHECKING

from cdia_pin.campaigns.campaign_result import HEALTHY
from cdia_pin.campaigns.estimates import LEVEL
from cdia_pin.phrases import counted
from cdia_pin.viewers.cells import table_of
from cdia_pin.viewers.words import number, percent

if TYPE_CHECKING:
    from rich.table import Table

    from cdia_pin.campaigns.campaign_result import CampaignResult, Cell
    from cdia_pin.campaigns.estimates import Estimate

HEADINGS = ("detected", "after", "named exactly", "tracking", "without monitor", "false alarms")
INTERVALS = f"Intervals hold the truth in {percent(LEVEL)} of campaigns."
MEANING = (
    "after: median from the onset to the detection, and what 90 % stay below. tracking: RMS error of the worst joint "
    f"over that of the healthy arm, median. {INTERVALS}"
)


def campaign_answer(found: CampaignResult) -> list[str]:
    """Return the short answer, a sentence or two for each settings of the engine.

    Args:
        found: The result.
    """
    said = []
    for cell in found.whole:
        settings = f"{cell.settings}: " if cell.settings else ""
        parts = []
        if cell.detected.count:
            after = (
                f", half of them within {time_words(cell.delay.value)}" if isfinite(cell.delay.value) else ""
            )
            parts.append(
                f"{share_words(cell.detected)} of {counted(cell.detected.count, 'fault')} detected{after}"
            )
            parts.append(f"{share_words(cell.exact)} named exactly")
        parts.append(alarm_words(cell))
        said.append(f"{settings}{'; '.join(parts)}.")
    missing = found.planned - found.runs
    failed = sum(cell.failed for cell in found.whole)
    if missing:
        said.append(f"{missing} of {counted(found.planned, 'run')} not made yet.")
    if failed:
        said.append(f"{failed} of {counted(found.planned, 'run')} could not be made.")
    return said


def campaign_rows(found: CampaignResult) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return headings and a line for each combination, without what is the same for all of them.

    Args:
        found: The result.
    """
    asked = ("settings", "robot", "model_error", "noise", "speed")
    kept = [name for name in asked if len({getattr(c, name) for c in found.cells}) > 1]
    heads = (*(name.replace("_", " ") for name in kept), "fault", "size", "runs", *HEADINGS)
    rows = [(*(_given(getattr(c, name)) for name in kept), *_cells(c)) for c in found.cells]
    return heads, rows


def campaign_table(found: CampaignResult) -> Table:
    """Return a table with a line for each combination.

    Args:
        found: The result.
    """
    heads, rows = campaign_rows(found)
    table = table_of(heads, rows, left=tuple(range(heads.index("fault") + 1)))
    table.caption = MEANING
    return table


def names_rows(found: CampaignResult) -> list[tuple[str, str, str]]:
    """Return what was hidden, what was believed at the end, and in how many runs.

    Args:
        found: The result.
    """
    return [
        (fault.replace("+", " + "), named.replace("+", " + "), f"{count} of {sum(counts.values())}")
        for fault, counts in found.names.items()
        for named, count in counts.items()
    ]


def names_table(found: CampaignResult) -> Table:
    """Return which names the hidden effects were given.

    Args:
        found: The result.
    """
    return table_of(("hidden", "believed at the end", "runs"), names_rows(found), left=(0, 1))


def worst_rows(found: CampaignResult, folder: str) -> list[tuple[str, ...]]:
    """Return the worst runs with the command that makes each again.

    Args:
        found: The result.
        folder: Of the campaign.
    """
    return [
        (str(row.number), row.terms or HEALTHY, why, f"cdia campaign {folder} --replay {row.number}")
        for row, why in found.worst
    ]


def share_words(estimate: Estimate) -> str:
    """Return a share with its interval.

    Args:
        estimate: The share [1].
    """
    if not estimate.count:
        return "–"
    return f"{percent(estimate.value)} [{_bare(estimate.lower)}, {_bare(estimate.upper)}]"


def time_words(seconds: float) -> str:
    """Return a time in ms or s.

    Args:
        seconds: The time [s].
    """
    if isnan(seconds) or seconds == inf:
        return "never" if seconds == inf else "–"
    return f"{number(1e3 * seconds, 2)} ms" if seconds < 1 else f"{number(seconds, 2)} s"


def alarm_words(cell: Cell) -> str:
    """Return the false alarms of a combination in words.

    Args:
        cell: The combination.
    """
    count, hours = cell.false_alarms.count, number(cell.hours, 2)
    if not cell.hours:
        return "no time without a fault, so no false alarms to count"
    alarms = f"{counted(count, 'false alarm')} in {hours} h"
    return f"{alarms}: at most {number(cell.false_alarms.upper, 2)} an hour"


def _cells(cell: Cell) -> tuple[str, ...]:
    size = "" if isnan(cell.share) else percent(cell.share)
    if not cell.detected.count:
        return (cell.fault, size, str(cell.runs), *("–",) * 5, _rate(cell.false_alarms))
    after = f"{time_words(cell.delay.value)}, {time_words(cell.late)}"
    return (
        cell.fault.replace("+", " + "),
        size,
        str(cell.runs),
        share_words(cell.detected),
        after,
        share_words(cell.exact),
        _times(cell.tracking),
        _times(cell.tracking_alone),
        _rate(cell.false_alarms),
    )


def _rate(estimate: Estimate) -> str:
    if isnan(estimate.value):
        return "–"
    return f"{number(estimate.value, 2)} [{number(estimate.lower, 2)}, {number(estimate.upper, 2)}] /h"


def _times(estimate: Estimate) -> str:
    if isnan(estimate.value):
        return "–"
    if estimate.value == inf:
        return "ran away"
    if isnan(estimate.lower):
        return f"{number(estimate.value)} ×"
    return f"{number(estimate.value)} [{number(estimate.lower)}, {number(estimate.upper)}] ×"


def _bare(portion: float) -> str:
    return f"{100 * portion:.0f}"


def _given(value: object) -> str:
    return number(value) if isinstance(value, float) else str(value) or "defaults"
