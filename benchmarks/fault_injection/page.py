"""The page docs/results-bad-samples.md, from outcomes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from benchmarks.claims import met
from benchmarks.fault_injection.kinds import kinds
from benchmarks.fault_injection.recordings import FAULT_AT, LENGTH, SIZE
from benchmarks.fault_injection.running import MOST_PUSH, fell_short
from benchmarks.fault_injection.trial import ENGINES, SPOILED_AT, Outcome
from benchmarks.markdown import Row, table
from benchmarks.publishing import made_by

PACKAGES = ("pin", "mujoco", "numba", "numpy")  # whose versions matter


def page(outcomes: Sequence[Outcome], command: str) -> str:
    """Return the results as Markdown."""
    parts = [_head(outcomes, command), "## Must show"]
    parts += [table(("claim", "target", *ENGINES, "met"), _claims(outcomes)), "## By kind"]
    parts += [
        "`alarms` are detections without a name before the fault: the residual has left its threshold, and nothing "
        "was blamed. They are allowed, and counted here.",
        table(
            ("kind", "runs", "largest push", "alarms", "median delay of the later fault", "misses"),
            _by_kind(outcomes),
        ),
        "## Where it falls short",
        *_failures(outcomes),
    ]
    return "\n\n".join(parts) + "\n"


def _head(outcomes: Sequence[Outcome], command: str) -> str:
    arms = ", ".join(dict.fromkeys(o.arm for o in outcomes))
    ticks = sum(o.ticks for o in outcomes)
    return (
        "# Results with bad samples\n\n"
        f"{made_by(command, PACKAGES)}\n\n"
        f"{len(outcomes)} runs, {ticks:.3g} ticks: {len(kinds()) - 1} kinds of bad samples, and none, on {arms}, "
        f"with both engines. A run of a healthy arm of {LENGTH:g} s at 1 kHz (MuJoCo, masses up to 3 % wrong, "
        "the sensors of [the monitor's results](results-online.md)) is replayed. Bad samples begin between "
        f"{SPOILED_AT[0]:g} and {SPOILED_AT[1]:g} s, on a joint that moves. At {FAULT_AT:g} s dry friction begins, "
        f"{SIZE:g} × the engine's bound of a healthy residual, on a joint where the engine sees it without bad "
        "samples; it is added to the torque, as if the drive overcame it. Motions, ticks and joints are drawn by "
        "the names of the runs (`benchmarks/fault_injection`). Where an arm's file states no effort limit, the "
        "largest healthy torque of the joint takes its place."
    )


def _claims(outcomes: Sequence[Outcome]) -> Iterator[Row]:
    of = [[o for o in outcomes if o.engine == engine] for engine in ENGINES]

    def row(claim: str, target: str, measured: list[str], holds: bool) -> Row:
        return claim, target, *measured, met(holds)

    def none(claim: str, count: Callable[[Outcome], int], of_runs: bool = True) -> Row:
        counts = [sum(map(count, one)) for one in of]
        shown = [f"{c}/{len(one)}" if of_runs else str(c) for c, one in zip(counts, of, strict=True)]
        return row(claim, "0", shown, not any(counts))

    yield none("runs in which something was raised", lambda o: bool(o.raised))
    yield none(
        "ticks with a number that is not finite, or a torque beyond its limit", lambda o: o.not_finite, False
    )
    yield none("runs in which a fault of the arm was named before there was one", lambda o: bool(o.named))
    yield none("runs in which a sound sensor was named", lambda o: bool(o.wrongly))
    pushes = [max(o.pushed for o in one) for one in of]
    many = [sum(o.pushed > MOST_PUSH for o in one) for one in of]
    yield row(
        "largest correction before the fault, of the effort limit, and runs beyond the target",
        f"≤ {MOST_PUSH:.0%}",
        [f"{p:.1%}, {k}/{len(one)}" for p, k, one in zip(pushes, many, of, strict=True)],
        max(pushes) <= MOST_PUSH,
    )
    asked = [[o for o in one if o.expected] for one in of]
    found = [sum(o.expected in o.accused for o in one) for one in asked]
    yield row(
        "sensors that are frozen, dead, biased or shifted for a second or more: named",
        "all",
        [f"{f}/{len(one)}" for f, one in zip(found, asked, strict=True)],
        all(f == len(one) for f, one in zip(found, asked, strict=True)),
    )
    seen = [sum(np.isfinite(o.seen_after) for o in one) for one in of]
    yield row(
        "later faults of the arm: seen within a second",
        "all",
        [f"{s}/{len(one)}" for s, one in zip(seen, of, strict=True)],
        all(s == len(one) for s, one in zip(seen, of, strict=True)),
    )


def _by_kind(outcomes: Sequence[Outcome]) -> Iterator[Row]:
    for kind in kinds():
        runs = [o for o in outcomes if o.kind == kind.name]
        delay = float(np.median([o.seen_after for o in runs]))
        misses = sum(bool(fell_short(o)) for o in runs)
        yield (
            kind.name,
            len(runs),
            f"{max(o.pushed for o in runs):.1%}",
            sum(o.alarms for o in runs),
            f"{1e3 * delay:.0f} ms",
            misses or "",
        )


def _failures(outcomes: Sequence[Outcome]) -> Iterator[str]:
    lines = [f"- `{o.id}`: {'; '.join(why)}" for o in outcomes if (why := fell_short(o))]
    yield "\n".join(lines) or "Nowhere in these runs."
