"""Let effects end in measured logs: the monitor must say so, and name no other in their place.

Usage:
    python -m benchmarks.monitored_logs.ending               # draws for reporting; some minutes
    python -m benchmarks.monitored_logs.ending --suite tuning
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.markdown import Row, table
from benchmarks.measured_logs import folder
from benchmarks.monitored_logs.cases import DRAWS, EFFECT, SHARE, Case, planned
from benchmarks.monitored_logs.trial import monitor_of, with_effect
from benchmarks.outcomes import tell
from benchmarks.publishing import made_by, publish, stated
from benchmarks.real_residuals.draws import NoSizeError
from cdia_pin.effects import ExternalWrench, Term

PRESENT = (0.2, 0.6)  # [1], begin and end of the effect over the length of the log


@dataclass(frozen=True)
class Ended:
    """What the monitor said of an effect that ended.

    Attributes:
        case: The case.
        effect: Label of the effect.
        believed: What was believed before its end.
        left: What is believed at the end of the log.
        cleared: Time from its end until nothing is believed for the first time [s]; infinite if that never is.
        wrong: Time after its end for which another name is said, contact left out [s].
    """

    case: Case
    effect: str
    believed: tuple[str, ...]
    left: tuple[str, ...]
    cleared: float
    wrong: float


def main() -> None:
    """Monitor the logs and print the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.monitored_logs.ending", description="Let effects end in measured logs."
    )
    folder.add_option(given)
    given.add_argument("--suite", choices=list(DRAWS), default="reporting", help="which draws")
    given.add_argument("--out", type=Path, help="page to write; printed without it")
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        return
    os.environ[folder.VARIABLE] = str(options.data)
    cases = [c for c in planned(options.suite) if c.kind == EFFECT]
    found: list[Ended] = []
    for k, case in enumerate(cases, 1):
        try:
            found.append(monitored(case))
        except NoSizeError:
            continue
        tell(f"{k} of {len(cases)}  {case.id}  {', '.join(found[-1].left) or 'nothing'}")
    publish(page(found, stated(given, options, ("suite",))), options.out)


def monitored(case: Case) -> Ended:
    """Monitor the log of a case, with its effect in a part of it."""
    log = case.after.read()
    begin, end = (float(log.time[0] + share * log.duration) for share in PRESENT)
    watched, term = with_effect(case, log, begin, end)
    monitor = monitor_of(case.before)
    said: list[tuple[float, tuple[str, ...]]] = [(begin, ())]
    monitor.replay(watched, lambda s: said.append((s.time, _names(s.faults))))
    after = [(t, names) for t, names in said if t >= end]
    steps = np.diff([t for t, _ in after], append=after[-1][0])
    return Ended(
        case,
        term.label,
        believed=[names for t, names in said if t < end][-1],
        left=after[-1][1],
        cleared=next((t - end for t, names in after if not names), np.inf),
        wrong=float(sum(dt for dt, (_, names) in zip(steps, after, strict=True) if {*names} - {term.label})),
    )


def _names(faults: Sequence[Term]) -> tuple[str, ...]:
    """Return the labels of faults, contact left out."""
    return tuple(sorted(t.label for t in faults if not isinstance(t.effect, ExternalWrench)))


def page(found: Sequence[Ended], command: str) -> str:
    """Return the page.

    Args:
        found: What was said in each case.
        command: That made it.
    """
    arms = list(dict.fromkeys(f.case.arm for f in found))
    rows = [
        (f.case.id, f.effect, ", ".join(f.believed), ", ".join(f.left), f"{f.cleared:.1f}", f"{f.wrong:.1f}")
        for f in found
        if f.believed
    ]
    return "\n\n".join(
        [
            "# Effects that end in measured logs",
            made_by(command, ("numpy", "numba", "pin")),
            f"An effect of {SHARE:.0%} of its joint's RMS torque is there from {PRESENT[0]:.0%} to {PRESENT[1]:.0%} "
            "of a log. Those that are believed when it ends are asked.",
            table(
                (
                    "arm",
                    "believed when it ends",
                    "nothing at the end of the log",
                    "cleared after [s], median",
                    "another name meanwhile",
                ),
                _by_arm(found, arms),
            ),
            table(
                (
                    "case",
                    "put in",
                    "believed when it ends",
                    "at the end",
                    "cleared after [s]",
                    "another name for [s]",
                ),
                rows,
            ),
        ]
    )


def _by_arm(found: Sequence[Ended], arms: Sequence[str]) -> Iterator[Row]:
    for name, of in [("all", list(arms)), *((a, [a]) for a in arms)]:
        some = [f for f in found if f.case.arm in of]
        believed = [f for f in some if f.believed]
        yield (
            name,
            f"{len(believed)} of {len(some)}",
            f"{sum(not f.left for f in believed)} of {len(believed)}",
            f"{np.median([f.cleared for f in believed]):.1f}" if believed else "–",
            f"{sum(f.wrong > 0.0 for f in believed)} of {len(believed)}",
        )


if __name__ == "__main__":
    main()
