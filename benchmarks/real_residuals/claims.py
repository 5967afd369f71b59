"""What is asked of the program on real residuals, figure by figure, from the outcomes of the cases."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

from benchmarks.claims import (
    Claim,
    Figure,
    Measure,
    Part,
    Test,
    at_least,
    at_most,
    counted,
    median_of,
    of_cases,
)
from benchmarks.real_residuals.cases import ALONE, COMPARE, GONE, KNOWN, MODEL, UNCHANGED
from benchmarks.real_residuals.outcome import Outcome
from cdia_pin.changes.confidence import Confidence

EXACT = {25: 0.85, 10: 0.65}  # share of the cases of each size [%] to be named exactly
AMONG = {25: 0.92, 10: 0.75}
PAIRS = "number of pairs"  # one arm has too few
QUIET, LEAST_PAIRS = 0.95, 40  # share of unchanged pairs in which nothing is named, and of how many at least
POINTS = 0.05  # [1], by which a discovery from a model may name fewer than a comparison
SIZE_ERROR, HELD = 0.05, 0.90  # [1]
SAME = 0.95  # share of cases with the same names on a log recorded otherwise
COMPARE_SECONDS, DISCOVER_SECONDS = 4.0, 10.0  # [s], processor time


def asked(o: Outcome) -> bool:
    """Tell whether a case could be asked, on logs as they are."""
    return not o.impossible and not o.variant


def of(flow: str, size: int | None = None) -> Test:
    """Return a test: a case with an inserted effect, of one flow and size, or of any size."""

    def test(o: Outcome) -> bool:
        return asked(o) and o.flow == flow and (o.size > 0 if size is None else o.size == size)

    return test


def unchanged(flow: str) -> Test:
    """Return a test: a pair into which nothing was put."""
    return lambda o: asked(o) and o.flow == flow and o.effect == UNCHANGED


def size_error(outcomes: Sequence[Outcome]) -> Figure:
    """Return the median relative error of the parameters that tell a size, where the effect was named."""
    return median_of([e for o in outcomes for e in o.errors.values()])


def held(outcomes: Sequence[Outcome]) -> Figure:
    """Return how many of their intervals hold the truth."""
    return counted([h for o in outcomes for h in o.held.values()])


def right_of(confidence: Confidence) -> Measure:
    """Return a measure: how many of the names given with one confidence are right."""
    return lambda os: counted([n.label == o.truth for o in os for n in o.named if n.confidence == confidence])


def slowest(outcomes: Sequence[Outcome]) -> Figure:
    """Return the longest processor time of a question [s]."""
    times = [o.seconds for o in outcomes if not o.failure]
    return Figure(max(times), len(times), f"{max(times):.1f} s") if times else Figure(nan, 0, "–")


def behind(good: Test) -> Measure:
    """Return a measure: the share of good cases of a discovery from a model, less that of the same comparisons."""

    def measure(outcomes: Sequence[Outcome]) -> Figure:
        model = {o.draw: good(o) for o in outcomes if o.flow == MODEL}
        both = {o.draw: good(o) for o in outcomes if o.flow == COMPARE and o.draw in model}
        if not both:
            return Figure(nan, 0, "–")
        less = (sum(model[d] for d in both) - sum(both.values())) / len(both)
        return Figure(less, len(both), f"{100 * less:+.0f} points")

    return measure


def same_names(of_these: Test = lambda _: True) -> Measure:
    """Return a measure: how many cases have the same names on a log recorded otherwise.

    Args:
        of_these: Which cases count, on the logs as they are.
    """

    def measure(outcomes: Sequence[Outcome]) -> Figure:
        plain = {o.plain: o for o in outcomes if not o.variant and of_these(o)}
        varied = [o for o in outcomes if o.variant and not o.impossible and o.plain in plain]
        return counted([not o.failure and o.labels == plain[o.plain].labels for o in varied])

    return measure


def _exact(o: Outcome) -> bool:
    return o.exact


def _among(o: Outcome) -> bool:
    return o.among


def _named(size: int) -> tuple[Claim, ...]:
    claims = [
        Claim(text, f"≥ {wanted[size]:.0%}", of_cases(good), at_least(wanted[size]))
        if size in wanted
        else Claim(text, "", of_cases(good))
        for text, good, wanted in (
            ("exactly the effect is named", _exact, EXACT),
            ("the effect is among the named", _among, AMONG),
        )
    ]
    return (
        *claims,
        Claim("nothing is named", "", of_cases(lambda o: o.answer == "nothing")),
        Claim("others are named, and not the effect", "", of_cases(lambda o: o.answer == "other")),
    )


def _without_targets(claims: Sequence[Claim]) -> tuple[Claim, ...]:
    return tuple(Claim(c.text, "", c.measure) for c in claims)


def _sizes() -> tuple[Claim, ...]:
    return (
        Claim("relative error of sizes, median", f"≤ {SIZE_ERROR:.0%}", size_error, at_most(SIZE_ERROR)),
        Claim("95 % intervals of sizes hold the truth", f"≥ {HELD:.0%}", held, at_least(HELD)),
    )


def _quiet() -> tuple[Claim, ...]:
    return (
        Claim("nothing is named", f"≥ {QUIET:.0%}", of_cases(lambda o: not o.named), at_least(QUIET)),
        Claim(
            PAIRS,
            f"≥ {LEAST_PAIRS}",
            lambda os: Figure(len(os), len(os), str(len(os))),
            at_least(LEAST_PAIRS),
        ),
    )


def _either(o: Outcome) -> bool:
    return asked(o) and o.flow in {COMPARE, MODEL} and o.effect != KNOWN


def _within(text: str, good: Test, chosen: Test) -> Claim:
    return Claim(
        f"{text}, less those of `compare A B` on the same cases",
        f"≥ −{100 * POINTS:.0f} points",
        lambda os: behind(good)([o for o in os if chosen(o)]),
        at_least(-POINTS),
    )


PARTS = (
    *(
        Part(
            f"`compare A B`, effects of {size} %",
            f"An effect of {size} % of the joint's RMS torque was put into B.",
            of(COMPARE, size),
            _named(size),
        )
        for size in (25, 10, 5)
    ),
    Part(
        "`compare A B`, sizes",
        "Parameters that make at least a fifth of the effect's torque, of effects that were named, 10 and 25 %.",
        lambda o: of(COMPARE)(o) and o.size >= 10,
        _sizes(),
    ),
    Part(
        "`compare A B`, confidence",
        "How many of all names given are right, by the confidence that they were given with; 10 and 25 %. Shown "
        "without a target.",
        lambda o: of(COMPARE)(o) and o.size >= 10,
        (
            Claim("names called established are right", "", right_of(Confidence.ESTABLISHED)),
            Claim("names called likely are right", "", right_of(Confidence.LIKELY)),
        ),
    ),
    Part("`compare A B`, nothing added", "Both logs as they were measured.", unchanged(COMPARE), _quiet()),
    *(
        Part(
            f"`compare B A`, effects of {size} % that are gone",
            "The effect is in the log before. Shown without a target.",
            of(GONE, size),
            _without_targets(_named(size)),
        )
        for size in (25, 10, 5)
    ),
    Part(
        "`discover B --model`, against `compare A B`",
        "What `discover` found on A is the model; the same draws.",
        _either,
        (
            _within("25 %: exactly the effect", _exact, lambda o: o.size == 25),
            _within("25 %: among the named", _among, lambda o: o.size == 25),
            _within("10 %: exactly the effect", _exact, lambda o: o.size == 10),
            _within("10 %: among the named", _among, lambda o: o.size == 10),
            _within("nothing added: nothing is named", _exact, lambda o: o.effect == UNCHANGED),
        ),
    ),
    *(
        Part(
            f"`discover B --model`, effects of {size} %",
            "Only one draw in two: a discovery takes longer.",
            of(MODEL, size),
            _named(size) if size not in EXACT else _without_targets(_named(size)),
        )
        for size in (25, 10, 5)
    ),
    Part(
        "`discover B --model`, sizes",
        "As above.",
        lambda o: of(MODEL)(o) and o.size >= 10,
        _sizes(),
    ),
    Part(
        "`discover B` alone",
        "Named: what is found in B with the effect and not in B without, or with parameters that differ by more than "
        "both intervals. 10 and 25 %; shown without a target.",
        of(ALONE),
        _without_targets((*_named(25), *_sizes())),
    ),
    Part(
        "The same log, recorded otherwise",
        "Both torques filtered at half their bandwidth, or both logs resampled to three quarters of their rate: "
        "effects of 25 %, unchanged pairs and the known payload.",
        lambda o: o.flow == COMPARE and not o.impossible,
        (
            Claim("`compare A B` gives the same names", f"≥ {SAME:.0%}", same_names(), at_least(SAME)),
            Claim("the same where it names something", "", same_names(lambda o: bool(o.named))),
        ),
    ),
    Part(
        "Time",
        "Processor time of a question, without reading logs.",
        asked,
        (
            Claim(
                "`compare A B`, the slowest",
                f"≤ {COMPARE_SECONDS:g} s",
                lambda os: slowest([o for o in os if o.flow == COMPARE]),
                at_most(COMPARE_SECONDS),
            ),
            Claim(
                "`discover B` with or without a model, the slowest",
                f"≤ {DISCOVER_SECONDS:g} s",
                lambda os: slowest([o for o in os if o.flow in {MODEL, ALONE}]),
                at_most(DISCOVER_SECONDS),
            ),
        ),
    ),
)
