"""The claims, and the page docs/results-two-changes.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.claim_tables import by_part
from benchmarks.claims import Claim, Measure, Part, Test, counted, median_of, of_cases
from benchmarks.markdown import Row, details, table
from benchmarks.publishing import made_by
from benchmarks.real_residuals.page import PACKAGES
from benchmarks.real_residuals.recordings import ARMS
from benchmarks.two_changes.cases import EVERYDAY, SIZES
from benchmarks.two_changes.trial import Outcome
from cdia_pin.changes.confidence import Confidence


def page(outcomes: Sequence[Outcome], command: str, suite: str, whole: bool) -> str:
    """Return the results as Markdown.

    Args:
        outcomes: Of the cases.
        command: By which they are made.
        suite: Name of the draws.
        whole: Whether all was run.
    """
    asked = [o for o in outcomes if not o.impossible]
    arms = [a for a in ARMS if any(o.arm == a for o in asked)]
    sample = "" if whole else "**Some of the cases only, not the results.** "
    parts = [
        f"# Two changes at once\n\n{sample}{made_by(command, PACKAGES)}",
        f"{len(asked)} cases of the suite *{suite}*. Two effects of known size are put into the second of two measured "
        "logs, as one is in [the page of single effects](results-real-residuals.md), and `cdia compare` is asked for "
        "both. Every two of seven everyday effects are drawn on every pair of logs, one time in two on the same joint, "
        "unless one is of the whole arm or both would be one effect there. *Exact*: both are named on their joints, "
        "and nothing else. All is shown without a target.",
        *by_part(PARTS, asked, arms, lambda o: o.arm),
        "## Effect by effect",
        "Cases with both effects, exact of all. On one joint and on different joints.",
        table(("", *(f"`{e}`" for e in EVERYDAY[1:])), _by_effects(asked)),
        *_fell_short(asked),
    ]
    return "\n\n".join(parts) + "\n"


def _right_of(confidence: Confidence) -> Measure:
    return lambda os: counted([n.label in o.truth for o in os for n in o.named if n.confidence == confidence])


def _of(size: int) -> Test:
    return lambda o: o.size == size


def _is_exact(o: Outcome) -> bool:
    return o.exact


def _is_part(o: Outcome) -> bool:
    return bool(o.named) and o.labels < frozenset(o.truth)


def _is_wrong(o: Outcome) -> bool:
    return any(n.label not in o.truth and n.confidence == Confidence.ESTABLISHED for n in o.named)


PARTS = (
    *(
        Part(
            f"Both of {size} %",
            f"Each has {size} % of its joint's RMS torque.",
            _of(size),
            (
                Claim("exactly both are named", "", of_cases(_is_exact)),
                Claim("both are among the named", "", of_cases(lambda o: o.among)),
                Claim("exactly both, on one joint", "", of_cases(_is_exact, lambda o: o.on_one_joint)),
                Claim(
                    "exactly both, on different joints", "", of_cases(_is_exact, lambda o: not o.on_one_joint)
                ),
                Claim("one of them is named, and nothing wrong", "", of_cases(_is_part)),
                Claim("nothing is named", "", of_cases(lambda o: not o.named)),
                Claim("a wrong name is established", "", of_cases(_is_wrong)),
            ),
        )
        for size in reversed(SIZES)
    ),
    Part(
        "Names and sizes",
        "How many of all names given are right, and the parameters that tell how large an effect is.",
        lambda _: True,
        (
            Claim("names called established are right", "", _right_of(Confidence.ESTABLISHED)),
            Claim("names called likely are right", "", _right_of(Confidence.LIKELY)),
            Claim(
                "relative error of sizes, median", "", lambda os: median_of([e for o in os for e in o.errors])
            ),
            Claim(
                "95 % intervals of sizes hold the truth",
                "",
                lambda os: counted([h for o in os for h in o.held]),
            ),
        ),
    ),
)


def _by_effects(outcomes: Sequence[Outcome]) -> Iterator[Row]:
    for k, one in enumerate(EVERYDAY[:-1]):
        some = [[o for o in outcomes if set(o.effects) == {one, other}] for other in EVERYDAY[1:]]
        cells = (f"{sum(o.exact for o in s)} of {len(s)}" if s and i >= k else "" for i, s in enumerate(some))
        yield (f"`{one}`", *cells)


def _fell_short(outcomes: Sequence[Outcome]) -> Iterator[str]:
    wrong = [o for o in outcomes if not o.exact]
    if wrong:
        rows = ((f"`{o.id}`", _listed(o.truth), said(o)) for o in sorted(wrong, key=lambda o: o.id))
        yield "## Where it falls short"
        yield details(f"not exact: {len(wrong)} of {len(outcomes)}", table(("case", "truth", "named"), rows))


def _listed(labels: Sequence[str]) -> str:
    return ", ".join(f"`{x}`" for x in labels)


def said(o: Outcome) -> str:
    """Return what was named, in a line.

    Args:
        o: What came of a case.
    """
    return o.failure or ", ".join(f"`{n.label}` {n.confidence}" for n in o.named) or "nothing"
