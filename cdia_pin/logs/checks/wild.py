"""Single samples of a log that no motion makes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.log import Log
from cdia_pin.logs.wild_samples import LARGEST_SHARE, NAMED, WildSample, share_of
from cdia_pin.phrases import counted


def check_wild(log: Log, found: Sequence[WildSample]) -> Iterator[Finding]:
    """Report values that no motion makes.

    Args:
        log: The log.
        found: Its wild samples.

    Yields:
        A finding per signal of a joint that has some.
    """
    by_signal: dict[tuple[str, str], list[WildSample]] = {}
    for sample in found:
        by_signal.setdefault((sample.signal, sample.joint), []).append(sample)
    # A bad velocity spoils no comparison, which derives it from the position.
    spoiling = share_of([s for s in found if s.signal != "velocity"], log) > LARGEST_SHARE
    for (signal, joint), samples in by_signal.items():
        too_many = spoiling and signal != "velocity"
        spoiled = signal == "velocity" and len(samples) > LARGEST_SHARE * len(log.time)
        named = ", ".join(f"{s.value:.4g} at t = {s.time:.6g} s" for s in samples[:NAMED])
        more = f", … ({len(samples)} in all)" if len(samples) > NAMED else ""
        yield Finding(
            Topic.WILD,
            Severity.ERROR if too_many else Severity.WARNING,
            f"the {signal} has {counted(len(samples), 'value')} that no motion makes: {named}{more}; "
            "the other checks leave them out",
            joint=joint,
            advice="find out what went wrong when the log was recorded"
            if too_many
            else "ignore the recorded velocities: --convert use_velocity=false"
            if spoiled
            else "nothing needs to be done: they are left out of all that is computed",
            value={
                "signal": signal,
                "count": len(samples),
                "share": len(samples) / len(log.time),
                "rows": [s.row for s in samples[:100]],
            },
        )
