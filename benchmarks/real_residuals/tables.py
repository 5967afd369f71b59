"""Tables beside the claims: effect by effect, log by log, and what fell short."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan

from benchmarks.claims import counted
from benchmarks.markdown import Row, details, table
from benchmarks.real_residuals.bases import Base
from benchmarks.real_residuals.cases import ALONE, FLOWS, SIZES
from benchmarks.real_residuals.claims import asked, held, size_error
from benchmarks.real_residuals.draws import RECIPES
from benchmarks.real_residuals.outcome import Outcome
from benchmarks.real_residuals.repeats import Repeat
from benchmarks.real_residuals.stability import lines
from cdia_pin.viewers.words import percent


def by_effect(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Yield a table for each flow: how each effect was answered, at each size."""
    sizes = [s for s in sorted(SIZES, reverse=True) if any(o.size == s for o in outcomes)]
    for flow in FLOWS:
        chosen = [o for o in outcomes if asked(o) and o.flow == flow]
        if not chosen or not sizes:
            continue
        heads = ("effect", *(f"{s} %: exact / among" for s in sizes), "error of sizes", "intervals hold")
        yield f"## Effect by effect, flow `{flow}`"
        yield table(heads, (_effect(e, sizes, [o for o in chosen if o.effect == e]) for e in RECIPES))


def _effect(effect: str, sizes: Sequence[int], outcomes: Sequence[Outcome]) -> Row:
    cells = []
    for size in sizes:
        some = [o for o in outcomes if o.size == size]
        exact, among = sum(o.exact for o in some), sum(o.among for o in some)
        cells.append(f"{exact} / {among} of {len(some)}" if some else "–")
    return (f"`{effect}`", *cells, size_error(outcomes).text, held(outcomes).text)


def of_untouched(bases: Sequence[Base], repeats: Sequence[Repeat]) -> Iterator[str]:
    """Yield the tables of untouched logs."""
    if bases:
        yield "## `discover` on untouched logs"
        heads = ("log", "named", "lines", "verdict", "held-out error over the URDF's", "s")
        yield table(heads, map(_base, sorted(bases, key=lambda b: b.id)))
    if repeats:
        yield "## Repeatability"
        yield (
            "Established names of two logs of one arm, parameters of those found in both, and the error of one's model "
            "on the other log over that of the URDF."
        )
        columns = ("logs", "names alike", "parameters agree", "first model on second log", "second on first")
        yield table(columns, map(_repeat, repeats))


def _base(b: Base) -> Row:
    if b.failure:
        return b.id, f"failed: {b.failure}", "–", "–", "–", f"{b.seconds:.1f}"
    return b.id, len(b.named), lines(b), b.verdict, percent(b.heldout), f"{b.seconds:.1f}"


def _repeat(r: Repeat) -> Row:
    if r.failure:
        return r.id, r.failure, "–", "–", "–"
    onto = ["–" if isnan(x) else percent(x) for x in r.carried_over]
    return (
        r.id,
        f"{r.alike:.2f} ({r.common} of {r.common + r.apart})",
        f"{r.within} of {r.compared}",
        *onto,
    )


def fell_short(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Yield every case that is not exact, with what was said, and those that could not be asked."""
    yield "## Where it falls short"
    for flow in FLOWS:
        some = [o for o in outcomes if asked(o) and o.flow == flow]
        wrong = [o for o in some if not o.exact]
        if wrong:
            rows = ((f"`{o.draw}`", f"`{o.truth}`" if o.truth else "–", _said(o)) for o in wrong)
            kind = "differs from `discover B` without the effect" if flow == ALONE else "named"
            body = table(("case", "truth", kind), rows)
            yield details(f"flow {flow}: not exact {counted([not o.exact for o in some]).text}", body)
    lost = {o.draw: o.impossible for o in outcomes if o.impossible}
    if lost:
        body = table(("case", "why"), ((f"`{k}`", v) for k, v in sorted(lost.items())))
        yield details(f"{len(lost)} draws that no joint can have at that size", body)


def _said(o: Outcome) -> str:
    return o.failure or ", ".join(f"`{x}`" for x in sorted(o.labels)) or "nothing"
