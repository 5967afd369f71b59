"""Single samples of a log that no motion makes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.log import Log
from cdia_pin.logs.wild_samples import LARGEST_SHARE, NAMED, WildSample, beginnings, failed_rows, too_many
from cdia_pin.phrases import counted

SPOILS = "find out what went wrong when the log was recorded"
NOTHING = "nothing needs to be done: they are left out of all that is computed"


def check_wild(log: Log, found: Sequence[WildSample]) -> Iterator[Finding]:
    """Report values that no motion makes.

    Args:
        log: The log.
        found: Its wild samples.

    Yields:
        A finding of rows that are wild as a whole, and one per signal of a joint that has other wild values.
    """
    # A bad velocity spoils no comparison, which derives it from the position.
    spoiling = too_many([s for s in found if s.signal != "velocity"], log)
    failed = failed_rows(found, log)
    if failed:
        times = ", ".join(f"{log.time[row]:.6g}" for row in failed[:NAMED])
        more = f", … ({len(failed)} in all)" if len(failed) > NAMED else ""
        yield Finding(
            Topic.WILD,
            Severity.ERROR if spoiling else Severity.WARNING,
            f"{counted(len(failed), 'row')} in which nothing was measured, as a bus that failed leaves: "
            f"at t = {times} s{more}; the other checks leave them out",
            advice=SPOILS if spoiling else NOTHING,
            value={"count": len(failed), "share": len(failed) / len(log.time), "rows": failed[:100]},
        )
    whole = set(failed)
    by_signal: dict[tuple[str, str], list[WildSample]] = {}
    for sample in (s for s in found if s.row not in whole):
        by_signal.setdefault((sample.signal, sample.joint), []).append(sample)
    for (signal, joint), samples in by_signal.items():
        spoils = spoiling and signal != "velocity"
        spoiled = signal == "velocity" and len(samples) > LARGEST_SHARE * len(log.time)
        first = beginnings(samples)
        named = ", ".join(s.seen for s in first[:NAMED])
        more = f", … ({len(samples)} in all)" if len(first) > NAMED else ""
        yield Finding(
            Topic.WILD,
            Severity.ERROR if spoils else Severity.WARNING,
            f"the {signal} has {counted(len(samples), 'value')} that no motion makes: {named}{more}; "
            "the other checks leave them out",
            joint=joint,
            advice=SPOILS
            if spoils
            else "ignore the recorded velocities: --convert use_velocity=false"
            if spoiled
            else NOTHING,
            value={
                "signal": signal,
                "count": len(samples),
                "share": len(samples) / len(log.time),
                "rows": [s.row for s in samples[:100]],
            },
        )
