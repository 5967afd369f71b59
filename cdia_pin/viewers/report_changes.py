"""The part of a report of several logs: what changed from the first to the others, and the error in each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

from cdia_pin.viewers.change_words import (
    change_rows,
    changes_sentence,
    doubts,
    is_quiet,
    names_of_logs,
    notes,
)
from cdia_pin.viewers.report_series import compact_one

if TYPE_CHECKING:
    from cdia_pin.changes import Changes
    from cdia_pin.discovery import Comparison


class ChangeDocument(TypedDict):
    """A change, in words."""

    name: str
    where: str
    differences: list[str]
    growth: str
    torque: str
    confidence: str


class ChangesDocument(TypedDict):
    """What changed between two groups of logs; ``quiet``: nothing did, and nothing seems to have."""

    sentence: str
    quiet: bool
    changes: list[ChangeDocument]
    doubts: list[str]
    notes: list[str]


class LogErrors(TypedDict):
    """Error of the model in one log over the measured torque, of each joint and their mean [1]."""

    name: str
    share: list[float | None]
    mean: float | None


def changes_data(found: Changes) -> ChangesDocument:
    """Return what a report shows of changes.

    Args:
        found: The outcome of ``what_changed``.
    """
    return {
        "sentence": changes_sentence(found),
        "quiet": is_quiet(found),
        "changes": [
            {
                "name": row.name,
                "where": row.where,
                "differences": list(row.differences),
                "growth": row.growth,
                "torque": row.torque,
                "confidence": str(row.confidence),
            }
            for row in change_rows(found)
        ],
        "doubts": doubts(found),
        "notes": notes(found),
    }


def log_errors(by_log: Sequence[Comparison]) -> list[LogErrors]:
    """Return the error of a model in each log.

    Args:
        by_log: The outcome of ``compare`` for each log.
    """
    return [
        {
            "name": name,
            "share": [compact_one(x) for x in c.relative_rms],
            "mean": compact_one(c.mean_error),
        }
        for name, c in zip(names_of_logs(by_log), by_log, strict=True)
    ]
