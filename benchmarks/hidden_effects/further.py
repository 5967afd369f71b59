"""Parts of the page that are not of cases: intervals and variances over many draws, and other tools."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan, nan
from statistics import median

from benchmarks.claims import Claim, Figure, counted
from benchmarks.hidden_effects.contest import OF_EACH, URDF, Score
from benchmarks.hidden_effects.precision import SHARE, TIMES, Precision
from benchmarks.markdown import Row, table
from cdia_pin.viewers.words import number

COVERED = (0.93, 0.97)
NAMELESS = (URDF, "figaroh")  # they do not say which effect is missing
NEAREST = 1.3  # variance over the bound [1]


def _coverage(rows: Sequence[Precision]) -> Figure:
    return counted([k < p.covered for p in rows for k in range(p.draws)])


def _variance(rows: Sequence[Precision]) -> Figure:
    found = [p.variance for p in rows if not p.searched]
    return Figure(max(found), len(found), f"{number(max(found))} the worst") if found else Figure(nan, 0, "–")


CLAIMS = (
    Claim(
        "Coloured noise: 95 % intervals hold the truth",
        "93 to 97 %",
        _coverage,
        lambda value: COVERED[0] <= value <= COVERED[1],
    ),
    Claim(
        "Coloured noise: variance over the Cramér-Rao bound of the whole log, no shape searched",
        f"≤ {NEAREST:g}",
        _variance,
        lambda value: value <= NEAREST,
    ),
)


def promised(rows: Sequence[Precision]) -> Iterator[Row]:
    """Yield what was promised of intervals and variances."""
    for claim in CLAIMS if rows else ():
        figure = claim.measure(rows)
        yield (claim.text, claim.target, figure.text, figure.n, claim.says(figure.value))


def precision_part(rows: Sequence[Precision]) -> Iterator[str]:
    """Yield the part about intervals and variances."""
    if not rows:
        return
    yield "## Intervals and variances"
    yield (
        f"One case of each effect, {SHARE:.0%}, coloured noise, under {TIMES} draws of it. *Over the bound*: variance "
        "of the estimates over the Cramér-Rao bound, from the true columns and the true covariance of the noise: of "
        "every sample of the log, and of what the conditioning keeps (low frequencies, no reversals). The variance "
        f"itself has a standard error of {(2 / (TIMES - 1)) ** 0.5:.0%}. *Bias*: in standard deviations of an estimate."
    )
    heads = (
        "effect",
        "arm",
        "parameter",
        "named",
        "interval holds",
        "over the bound",
        "over that of what is kept",
        "bias",
    )
    body = [
        (
            f"{p.effect}{', shape searched' * p.searched}",
            p.arm,
            p.parameter,
            p.draws,
            f"{p.covered / p.draws:.0%}",
            number(p.variance),
            "–" if p.searched else number(p.of_kept),
            f"{p.bias:+.2f}",
        )
        for p in rows
    ]
    yield table(heads, body)


def contest_part(scores: Sequence[Score]) -> Iterator[str]:
    """Yield the part about other tools."""
    if not scores:
        return
    yield "## Other tools on the same logs"
    cases = len({s.id.removesuffix(f"/{s.tool}") for s in scores})
    yield (
        f"{cases} of the single effects, the first {OF_EACH} of each kind that more than one tool can have in its "
        "model; another motion is predicted under our conditioning. How each is set up is in `benchmarks/peers`. A "
        "tool that is not installed is left out (`pip install -e .[bench]`; figaroh in an environment of its own)."
    )
    tools = dict.fromkeys(s.tool for s in scores)
    heads = (
        "tool",
        "fits",
        "failed",
        "median s",
        "held-out over the noise floor, median",
        "worst",
        "exact",
        "holds the truth",
        "effects named, median",
    )
    yield table(heads, [_row([s for s in scores if s.tool == t]) for t in tools])


def _row(scores: Sequence[Score]) -> Row:
    tool, fine = scores[0].tool, [s for s in scores if not isnan(s.over_floor)]
    if not fine:
        return (tool, 0, len(scores), *["–"] * 6)
    ratios = [s.over_floor for s in fine]
    names = ["–"] * 3 if tool in NAMELESS else _names(fine)
    return (
        tool,
        len(fine),
        len(scores) - len(fine),
        f"{median(s.seconds for s in fine):.1f}",
        number(median(ratios)),
        number(max(ratios)),
        *names,
    )


def _names(scores: Sequence[Score]) -> Row:
    return (
        counted([s.exact for s in scores]).text,
        counted([s.holds for s in scores]).text,
        number(median(s.named for s in scores)),
    )
