"""What is asked of the discovery, figure by figure, from the outcomes of the cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isnan, nan

import numpy as np

from benchmarks.claims import Claim, Figure, Measure, Part, at_least, at_most, counted, of_cases
from benchmarks.hidden_effects.oracle import CONFUSABLE
from benchmarks.hidden_effects.outcome import Outcome
from cdia_pin.viewers.words import number

WORST = 1.03  # held-out RMS over the noise floor [1]
COVERED = (0.93, 0.97)


def percentile(value: Callable[[Outcome], float], q: float) -> Measure:
    """Return a measure: a percentile of a number over the cases that have it."""

    def measure(outcomes: Sequence[Outcome]) -> Figure:
        found = [value(o) for o in outcomes if not isnan(value(o))]
        return (
            Figure(float(np.percentile(found, q)), len(found), number(np.percentile(found, q), 4))
            if found
            else Figure(nan, 0, "–")
        )

    return measure


def covered(outcomes: Sequence[Outcome]) -> Figure:
    """Return how many of the intervals of rightly named effects hold the truth."""
    return counted([c for o in outcomes for c in o.covered])


def _named(target: float) -> tuple[Claim, ...]:
    return (
        Claim(
            "exact names and joints, and nothing else, where they can be told",
            f"≥ {target:.0%}",
            of_cases(_exact, _told),
            at_least(target),
        ),
        Claim("the same of all cases", "", of_cases(_exact)),
        Claim("verdict `explained` where exact", "", of_cases(lambda o: o.verdict == "explained", _exact)),
        *_predicts(),
    )


def _predicts() -> tuple[Claim, ...]:
    return (
        Claim(
            "held-out RMS over the noise floor, RMS over the joints, where they can be told: 95th percentile",
            f"≤ {WORST:g}",
            lambda os: percentile(lambda o: o.mean_over_floor, 95)([o for o in os if o.told]),
            at_most(WORST),
        ),
        Claim(
            "the same, median",
            "",
            lambda os: percentile(lambda o: o.mean_over_floor, 50)([o for o in os if o.told]),
        ),
        Claim(
            f"cases whose worst joint is within {WORST:g}",
            "",
            of_cases(lambda o: o.over_floor <= WORST, _told),
        ),
        Claim("relative error of parameters rightly named, median", "", _errors),
    )


def _errors(outcomes: Sequence[Outcome]) -> Figure:
    errors = [e for o in outcomes for e in o.parameter_errors]
    return (
        Figure(float(np.median(errors)), len(errors), f"{100 * np.median(errors):.2g} %")
        if errors
        else Figure(nan, 0, "–")
    )


def _exact(o: Outcome) -> bool:
    return o.exact


def _told(o: Outcome) -> bool:
    return o.told


def _confused(o: Outcome) -> bool:
    return o.confused


def _unexplained(o: Outcome) -> bool:
    return o.verdict == "unexplained"


def _seen_through(o: Outcome) -> bool:
    effect, _, joint = o.hidden[0].partition("@")
    drifts = effect == "warming_friction" and o.found == (f"coulomb_friction@{joint}[time]",)
    has_memory = effect == "presliding" and o.found == (f"presliding_friction@{joint}",)
    return _unexplained(o) or drifts or has_memory


def of_suite(suite: str) -> Callable[[Outcome], bool]:
    """Return a test of outcomes."""
    return lambda o: o.suite == suite


PARTS = (
    Part(
        "Single effects",
        "Every effect of the vocabulary, every arm, every noise; good excitation.",
        of_suite("single"),
        _named(0.97),
    ),
    Part("Pairs", "Two effects, drawn; on one joint and on two in turn.", of_suite("pair"), _named(0.90)),
    Part("Triples", "Three effects, drawn.", of_suite("triple"), _named(0.75)),
    Part(
        "Clean logs",
        "Nothing is hidden; good and poor motions.",
        of_suite("clean"),
        (
            Claim("an effect is added", "≤ 1 %", of_cases(lambda o: bool(o.found)), at_most(0.01)),
            Claim("verdict `nothing-missing`", "", of_cases(lambda o: o.verdict == "nothing-missing")),
        ),
    ),
    Part(
        "Light wrists",
        "Nothing is hidden. Encoders of 2¹² to 2¹⁹ counts a turn; their steps make torque, through the accelerations, "
        "of the size of a wrist's own.",
        of_suite("light wrist"),
        (
            Claim("an effect is added", "none", of_cases(lambda o: bool(o.found)), at_most(0.0)),
            Claim("verdict `nothing-missing`", "", of_cases(lambda o: o.verdict == "nothing-missing")),
        ),
    ),
    Part(
        "Poor excitation",
        "Every effect on every arm on motions that show it poorly, and effects on motions on which others are the same "
        "torque. *Confusable*: it can be seen (λ ≥ 10²), but another effect with no more parameters is within λ < 4² "
        "of it. The set is what is found and what it is said to be confusable with; it must have more than one "
        "member. The motion is that of `excite` between the first two.",
        lambda o: o.suite in {"poor", "alike"},
        (
            Claim(
                "confusable: the set is reported, and holds the truth",
                "≥ 90 %",
                of_cases(lambda o: o.holds_truth, _confused),
                at_least(0.90),
            ),
            Claim(
                "confusable: exact with a log of the proposed motion added",
                "≥ 90 %",
                of_cases(lambda o: o.resolved is not None and o.same(o.resolved), _confused),
                at_least(0.90),
            ),
            Claim(
                "the same where a set was reported",
                "",
                of_cases(lambda o: o.same(o.resolved), lambda o: o.confused and o.resolved is not None),
            ),
            Claim("can be told: exact", "", of_cases(_exact, lambda o: o.told)),
            Claim(
                "cannot be seen: nothing is named",
                "",
                of_cases(lambda o: not o.found, lambda o: any(s.alone < CONFUSABLE for s in o.sights)),
            ),
        ),
    ),
    Part(
        "Model error",
        "Every link is 3 or 5 % wrong beside the hidden effect. Exact: what is named beside bodies "
        "(`link_inertia`, `payload`) is what is hidden.",
        of_suite("model error"),
        (
            Claim("exact where it can be told", "", of_cases(_exact, _told)),
            Claim("exact, of all", "", of_cases(_exact)),
            Claim("verdict `explained`", "", of_cases(lambda o: o.verdict == "explained")),
            *_predicts(),
        ),
    ),
    Part(
        "Outside the vocabulary",
        "Effects that no effect of the vocabulary describes. Friction that falls as it warms, and friction that builds "
        "up after a reversal, may be called what they are, Coulomb friction that drifts and presliding friction. "
        "*Can be told*: on this log the best single effect of the vocabulary misses them by λ ≥ 10²; a dead zone that "
        "the torque never crosses is an offset.",
        of_suite("outside"),
        (
            Claim(
                "verdict `unexplained`, or friction that drifts or has memory, where they can be told",
                "≥ 95 %",
                of_cases(_seen_through, _told),
                at_least(0.95),
            ),
            Claim("the same of all cases", "", of_cases(_seen_through)),
            Claim("verdict `unexplained`, of all", "", of_cases(_unexplained)),
        ),
    ),
)


def fell_short(o: Outcome) -> list[str]:
    """Return in what a case fell short, in words."""
    if o.suite == "outside":
        return ["not called unexplained"] * (o.told and not _seen_through(o))
    if o.suite in {"clean", "light wrist"}:
        return ["named something"] * bool(o.found) + ["called unexplained"] * (o.verdict == "unexplained")
    if o.confused:
        return ["the truth is not in the set"] * (not o.holds_truth)
    out = [] if o.exact or not o.told else ["not exact"]
    if o.told and o.exact and o.verdict != "explained":
        out.append(o.verdict)
    return out
