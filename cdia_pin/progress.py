"""How long work tells how far it is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float], None]  # a sentence, and the share done from 0 to 1


def silent(sentence: str, share: float) -> None:
    """Report to nobody.

    Args:
        sentence: What is being done.
        share: Share of the work that is done [1].
    """


def part(report: Progress, start: float, end: float) -> Progress:
    """Return how a part of some work reports its own progress.

    Args:
        report: How the whole work reports.
        start: Share of the whole at which the part begins [1].
        end: Share of the whole at which the part ends [1].
    """
    return lambda sentence, share: report(sentence, start + (end - start) * share)
