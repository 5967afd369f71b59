"""The page docs/results-real-residuals.md, and one of the same tables for another arm, from outcomes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.claim_tables import MUST_SHOW, by_part, targets
from benchmarks.markdown import table
from benchmarks.publishing import made_by
from benchmarks.real_residuals.bases import Base
from benchmarks.real_residuals.claims import PAIRS, PARTS
from benchmarks.real_residuals.known_truths import truths
from benchmarks.real_residuals.outcome import Outcome
from benchmarks.real_residuals.recordings import ARMS
from benchmarks.real_residuals.repeats import Repeat
from benchmarks.real_residuals.stability import stability
from benchmarks.real_residuals.tables import by_effect, fell_short, of_untouched

PACKAGES = ("pin", "numpy", "scipy")  # whose versions matter


def page(
    outcomes: Sequence[Outcome],
    bases: Sequence[Base],
    repeats: Sequence[Repeat],
    command: str,
    suite: str,
    whole: bool,
) -> str:
    """Return the results as Markdown.

    Args:
        outcomes: Of the cases.
        bases: Of untouched logs.
        repeats: Of pairs of them.
        command: By which they are made.
        suite: Name of the draws.
        whole: Whether all was run.
    """
    by_name = {b.id: b for b in bases}
    rows = [*targets(PARTS, outcomes), *truths(outcomes, by_name), *stability(by_name, repeats)]
    parts = [
        *(_opening(outcomes, command, suite, whole) if outcomes else _opening_of_untouched(command)),
        "## Must show",
        table(MUST_SHOW, [r for r in rows if whole or r[-2]]),  # of so many cases
        *_tables(outcomes),
        *of_untouched(bases, repeats),
        *fell_short(outcomes),
    ]
    return "\n\n".join(parts) + "\n"


def _opening(outcomes: Sequence[Outcome], command: str, suite: str, whole: bool) -> tuple[str, str]:
    sample = "" if whole else "**Some of the cases only, not the results.** "
    return (
        f"# Known effects on real residuals\n\n{sample}{made_by(command, PACKAGES)}",
        f"{_how(outcomes, suite)} The logs have licences of their own and do not ship. The monitor with an effect from "
        "the middle of B on is in [its own page](results-monitored-logs.md).",
    )


def _opening_of_untouched(command: str) -> tuple[str, str]:
    return (
        f"# What is found in measured logs as they are\n\n{made_by(command, PACKAGES)}",
        "`discover` on each measured log, on its halves, and on the log as if it had been recorded otherwise; nothing "
        "is put into them. The logs have licences of their own and do not ship. Known effects that are put into them "
        "are in [a page of their own](results-real-residuals.md).",
    )


def page_of_arm(arm: str, outcomes: Sequence[Outcome], command: str, suite: str) -> str:
    """Return the results of `compare` on logs of one more arm as Markdown.

    Args:
        arm: Its name.
        outcomes: Of the cases.
        command: By which they are made.
        suite: Name of the draws.
    """
    of_so_many_cases = [r for r in targets(PARTS, outcomes) if r[-2] and PAIRS not in r[0]]
    parts = [
        f"# Known effects on real residuals of {arm}\n\n{made_by(command, PACKAGES)}",
        _how(outcomes, suite),
        "## What other arms must show",
        table(MUST_SHOW, of_so_many_cases),
        *_tables(outcomes),
        *fell_short(outcomes),
    ]
    return "\n\n".join(parts) + "\n"


def _tables(outcomes: Sequence[Outcome]) -> Iterator[str]:
    arms = [a for a in ARMS if any(o.arm == a for o in outcomes)]
    yield from by_part(PARTS, outcomes, arms, lambda o: o.arm)
    yield from by_effect(outcomes)


def _how(outcomes: Sequence[Outcome], suite: str) -> str:
    return (
        f"{len(outcomes)} cases of the suite *{suite}*. The suite is part of each case's name, and the name is the "
        "seed of joint, sign and shape: no draw for tuning is one for reporting. Pairs of measured logs of real arms: "
        "A as it is, and an effect of known size put into B. The effect's torque f is computed along B's filtered "
        "motion, for a body from the rigid bodies with and without it, and the torque of B becomes τ − f; a gain "
        "divides the torque, an encoder's zero moves the positions, a delay shifts the torque. What no model explains "
        "stays as it was measured. A size is RMS torque over that of the joint on which the effect is largest. "
        "*Exact*: that effect on that joint is named, and no other. An arm whose sensors are behind the gears gets "
        "friction of the bearings and no effect of its motors."
    )
