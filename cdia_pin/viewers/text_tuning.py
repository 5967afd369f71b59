"""The choice of a monitor's settings in the terminal, and what was given up for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cdia_pin.phrases import counted
from cdia_pin.viewers.text_campaign import share_words, time_words
from cdia_pin.viewers.words import number

if TYPE_CHECKING:
    from cdia_pin.campaigns.tuning_result import TradeOff, TuningResult

FOUND = ("detected", "median", "90 %", "mean time to detect")
HEADINGS = ("γ [1/s]", "debounce", "threshold", *FOUND)
RATE_HEADINGS = ("false alarms [1/h]", "threshold", *FOUND)


def tuning_answer(found: TuningResult) -> list[str]:
    """Return the short answer.

    Args:
        found: The result.
    """
    best, rate = found.best, number(found.false_alarms, 2)
    said = [
        f"At {rate} false alarms an hour or fewer: γ = {best.settings['bandwidth']} /s, "
        f"{best.settings['debounce']} ticks in a row, thresholds {number(best.factor)} times the usual ones.",
        f"{share_words(best.detected)} of {counted(best.detected.count, 'fault')} cross the threshold, half of them "
        f"within {time_words(best.median_delay)}.",
    ]
    if best.extrapolated:
        said.append(
            f"The threshold has half of the false alarms, less than one in the {number(best.hours, 2)} h without a "
            "fault: it is extrapolated from the tail of the residuals."
        )
    if found.failed:
        said.append(f"{counted(found.failed, 'run')} could not be made.")
    return said


def option_rows(found: TuningResult) -> list[tuple[str, ...]]:
    """Return every filter and debounce at the stated rate, the chosen one marked.

    Args:
        found: The result.
    """
    return [
        (
            f"{'→ ' if o == found.best else ''}{o.settings['bandwidth']}",
            str(o.settings["debounce"]),
            f"{number(o.factor)} ×",
            *_found(o),
        )
        for o in found.options
    ]


def rate_rows(found: TuningResult) -> list[tuple[str, ...]]:
    """Return the chosen filter and debounce at other rates of the threshold.

    Args:
        found: The result.
    """
    return [
        (
            f"{number(2 * o.alarms_per_hour, 2)}{' (extrapolated)' if o.extrapolated else ''}",
            f"{number(o.factor)} ×",
            *_found(o),
        )
        for o in found.rates
    ]


def _found(option: TradeOff) -> tuple[str, ...]:
    return (
        share_words(option.detected),
        time_words(option.median_delay),
        time_words(option.late_delay),
        time_words(option.time_to_detect),
    )
