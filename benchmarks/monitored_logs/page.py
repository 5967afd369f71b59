"""The page of results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import nan

import numpy as np

from benchmarks.claim_tables import MUST_SHOW, by_part, targets
from benchmarks.claims import Claim, Figure, Measure, Part, at_least, at_most, of_cases
from benchmarks.markdown import details, table
from benchmarks.monitored_logs.cases import EFFECT, HEALTHY, PUSHED, SHARE, WEIGHT
from benchmarks.monitored_logs.outcome import Outcome
from benchmarks.publishing import made_by

PACKAGES = ("pin", "numba", "numpy", "scipy")  # whose versions matter
WEIGHED = 2.6  # [kg], on the flange of the UR10e, as the data say
HALVES = {"mass": "mass_half", "compared_mass": "compared_half"}  # half width of the interval of each mass
ARMS = ("panda", "ur10", "ur10e", "ur5", "kuka_lwr4", "double_pendulum")


def _total(value: str) -> Measure:
    """Return a measure: a number over all logs, and how long they are."""

    def measure(outcomes: Sequence[Outcome]) -> Figure:
        total = sum(int(getattr(o, value)) for o in outcomes)
        minutes = sum(o.kept for o in outcomes) / 60
        return Figure(total, len(outcomes), f"{total} in {minutes:.1f} min")

    return measure


def _median(value: str, unit: str = "") -> Measure:
    """Return a measure: the median of a number over the logs that have it."""

    def measure(outcomes: Sequence[Outcome]) -> Figure:
        given = [getattr(o, value) for o in outcomes if not np.isnan(getattr(o, value))]
        middle = float(np.median(given)) if given else nan
        return Figure(middle, len(given), f"{middle:.3g}{unit}" if given else "–")

    return measure


def _is_sized(o: Outcome) -> bool:
    return not np.isnan(o.size_error)


def _says_wrong(o: Outcome) -> bool:
    return any(not label.startswith("unknown@") for label in o.ever)


def _weight_error(outcomes: Sequence[Outcome]) -> Figure:
    return _error_of_mass(outcomes, "mass", "not named", ", {:.1f} s after the first detection")


def _compared_mass(outcomes: Sequence[Outcome]) -> Figure:
    return _error_of_mass(outcomes, "compared_mass", "not established")


def _error_of_mass(outcomes: Sequence[Outcome], value: str, missing: str, delay: str = "") -> Figure:
    """Return the error of a mass of the one log with a known weight [1]; in words with its interval and its delay."""
    if not outcomes:
        return Figure(nan, 0, "–")
    (o,) = outcomes
    mass, half = getattr(o, value), getattr(o, HALVES[value])
    if np.isnan(mass):
        return Figure(np.inf, 1, missing)
    return Figure(abs(mass / WEIGHED - 1.0), 1, f"{mass:.2f} ± {half:.2f} kg{delay.format(o.mass_after)}")


DETECTED = Claim("detected", "≥ 95 %", of_cases(lambda o: not np.isnan(o.detected)), at_least(0.95))
RIGHT = Claim(
    "right: named at the end, or among those that fit alike",
    "≥ 75 %",
    of_cases(lambda o: o.holds),
    at_least(0.75),
)
ESTABLISHED = "logs in which the comparison with the healthy log established something"
NOTICED = Claim(
    "detected, or established by the comparison at the end",
    "≥ 95 %",
    of_cases(lambda o: o.is_noticed),
    at_least(0.95),
)
EITHER = Claim(
    "right, of the monitor or of the comparison",
    "≥ 75 %",
    of_cases(lambda o: o.holds or o.lasts),
    at_least(0.75),
)
COMPARED = (
    Claim("right by the comparison", "", of_cases(lambda o: o.lasts)),
    Claim(
        "something else established by the comparison",
        "",
        of_cases(lambda o: bool(o.lasting) and not o.lasts),
    ),
)
PARTS = (
    Part(
        "Healthy logs",
        "Of each pair, the first log gave the model and the thresholds, and the second one is monitored.",
        lambda o: o.kind == HEALTHY,
        (
            Claim("detections", "0", _total("early"), at_most(0)),
            Claim("logs in which something was named", "", of_cases(lambda o: bool(o.ever))),
            Claim(ESTABLISHED, "", of_cases(lambda o: bool(o.lasting))),
        ),
    ),
    Part(
        "A known weight",
        "2.6 kg on the flange of the UR10e, whose drive gains are nominal; learned from `fourier_50s`.",
        lambda o: o.kind == WEIGHT,
        (
            Claim("payload named, mass within 15 %", "≤ 15 %", _weight_error, at_most(0.15)),
            Claim("and nothing else at the end", "", of_cases(lambda o: o.named == ("payload",))),
            Claim("payload by the comparison at the end, error of its mass", "", _compared_mass),
        ),
    ),
    Part(
        "Pushes by hand",
        "Nobody wrote down when and where, but for the force at the tool of one log.",
        lambda o: o.kind == PUSHED,
        (
            Claim("logs in which a joint's fault was named", "0", of_cases(_says_wrong), at_most(0)),
            Claim("contacts said", "", _total("contacts")),
            Claim(ESTABLISHED, "", of_cases(lambda o: bool(o.lasting))),
            Claim(
                "at rest: error of the force's size, median",
                "≤ 30 %",
                _median("force_error"),
                at_most(0.3),
            ),
            Claim(
                "at rest: share of the time above 10 N in which contact is said",
                "",
                _median("force_said"),
            ),
        ),
    ),
    Part(
        "Known effects from the middle on",
        f"An effect of {SHARE:.0%} of its joint's RMS torque begins in the middle of the second log. "
        "Asked at the end of the log, where its last part is compared with the healthy one too.",
        lambda o: o.kind == EFFECT,
        (
            DETECTED,
            Claim("delay of detection, median", "", _median("detected", " s")),
            RIGHT,
            Claim("named at the end", "", of_cases(lambda o: o.is_right)),
            Claim("named, and nothing else anywhere", "", of_cases(lambda o: o.is_alone)),
            Claim("error of the size of what is named, median", "", _median("size_error")),
            Claim(
                "95 % interval of what is named holds the size",
                "",
                of_cases(lambda o: o.is_within, _is_sized),
            ),
            Claim("half width of the interval over the size, median", "", _median("size_half")),
            Claim("a detection before it began", "", of_cases(lambda o: o.early > 0)),
            NOTICED,
            EITHER,
            *COMPARED,
        ),
    ),
    Part(
        "Of these, where the monitor did not call itself blind",
        "Before a log, it calls a joint blind where its threshold is above 30% of the joint's torque. An effect of "
        "the whole arm counts here where one joint is not blind.",
        lambda o: o.kind == EFFECT and not o.blind,
        (*(replace(c, target="") for c in (DETECTED, RIGHT, NOTICED, EITHER)), *COMPARED),
    ),
)


def page(outcomes: Sequence[Outcome], command: str) -> str:
    """Return the page.

    Args:
        outcomes: What came of the cases.
        command: That made it.
    """
    good = [o for o in outcomes if not o.failure]
    failures = [(o.id, o.failure) for o in outcomes if o.failure and o.failure != "no such size"]
    parts = [
        "# The monitor over measured logs",
        made_by(command, PACKAGES),
        "Six measured arms; `benchmarks/monitored_logs/cases.py` says which logs are healthy.",
        "## Must show",
        table(MUST_SHOW, targets(PARTS, good)),
        *by_part(PARTS, good, ARMS, lambda o: o.arm),
    ]
    if failures:
        parts += ["## Failures", table(("case", "failure"), failures)]
    rows = [
        (o.id, o.effect, ", ".join(o.named), ", ".join(o.lasting), "<br>".join(o.said[:12])) for o in good
    ]
    heads = ("case", "put in", "named at the end", "established by comparison", "said")
    parts.append(details("Every case", table(heads, rows)))
    return "\n\n".join(parts) + "\n"
