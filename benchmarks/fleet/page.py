"""The page of results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.stats import poisson

from benchmarks.fleet.judging import RATES, FaultOutcome, false_alarms, fault_outcomes, healthy_years, inside
from benchmarks.fleet.plan import (
    ARM,
    COULOMB_DECAY,
    GROWTH,
    LINKS,
    OF_DAY,
    PAYLOADS,
    SUITES,
    VISCOUS_DECAY,
    FleetRobotPlan,
)
from benchmarks.fleet.recording import DURATION, RATE
from benchmarks.fleet.tails import CHANGED, COURSES, LOGS, tails
from benchmarks.markdown import table
from benchmarks.publishing import made_by
from cdia_pin.fleet import FleetTrend
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.viewers.trend_words import agreement_words, course_words, trend_answer
from cdia_pin.viewers.words import number, sentence_case, with_interval

UNLIKELY = 0.05  # probability [1] of so many false alarms at the stated rate, below which it is not held
PACKAGES = ("mujoco", "pin", "numpy", "scipy")
Row = tuple[object, ...]


def page(
    plans: Sequence[FleetRobotPlan],
    joints: Sequence[str],
    trends: tuple[FleetTrend, FleetTrend],
    one: FleetTrend | None,
    seconds_per_log: float,
    command: str,
) -> str:
    """Return the page.

    Args:
        plans: The robots.
        joints: Names of their joints.
        trends: With and without temperature and load as regressors.
        one: The measured UR10e; None where its logs are not there.
        seconds_per_log: Processor time of a log through `cdia fleet add` [s]; NaN if none was added.
        command: What made the page.
    """
    trend, without = trends
    outcomes = list(fault_outcomes(trend, plans, joints))
    bare = list(fault_outcomes(without, plans, joints))
    faulty, days = len(outcomes), plans[0].days
    cost = (
        f" A log took {seconds_per_log:.2f} s of one core through `cdia fleet add`."
        if np.isfinite(seconds_per_log)
        else ""
    )
    parts = [
        "# Results of fleets",
        made_by(command, PACKAGES),
        "## A simulated fleet",
        f"{len(plans)} arms ({ARM}) in MuJoCo, one log of {DURATION:g} s at {RATE:g} Hz on each of "
        f"{days} days. Every "
        f"day has another motion, another payload ({', '.join(f'{m:g}' for m in PAYLOADS)} kg) and "
        "another temperature: "
        f"Coulomb friction falls by {100 * COULOMB_DECAY:g} % and viscous friction by {100 * VISCOUS_DECAY:g} % per "
        f"kelvin, exponentially, and both scatter by {100 * OF_DAY:g} % from day to day. The links are up to "
        f"{100 * LINKS:g} % off the URDF. The program knows the URDF alone. {faulty} arms get a fault in "
        "the second third "
        f"of the time, which steps or grows in {GROWTH:g} days. Draws for tuning (seeds "
        f"{SUITES['tuning']}000 and on) are "
        f"not those for reporting ({SUITES['reporting']}000 and on).{cost}",
        _size_note(plans),
        "The reporting draws had shown 7 of 8 faults named right, and a growing loss of gain as an offset, before the "
        "rule was made that what is looked for names a change rather than what is fitted without it. So the row of "
        "right names is not independent of these draws.",
        table(
            ("must show", "target", "measured", "met", "without temperature and load"),
            _claims(outcomes, bare, trend, without, plans),
        ),
        "### Each fault",
        "Delays count logs from the first one with the fault to the alarm. The bound is that of a CUSUM "
        "that knows the "
        "level, the spread and the size of the fault, at the same rate of false alarms [Lorden1971]. "
        "`cdia trend` knows "
        "none of them, and one bad log is no alarm for it. A fault that grows can be noticed before the "
        "bound, which is a "
        "mean.",
        table(
            ("robot", "hidden", "day", "said", "size hidden", "size said ± 95 %", "delay", "bound"),
            map(_fault_row, outcomes),
        ),
        "### False alarms",
        f"Robot-years without a fault: {number(healthy_years(plans), 3)}. Each parameter that crosses "
        "its limit counts, although "
        "several at once are one change for `cdia trend`.",
        table(
            (
                "stated rate a robot and year",
                "expected",
                "parameters with an alarm",
                "robots with one",
                "parameters without regressors",
            ),
            _false_rows(trend, without, plans),
        ),
    ]
    most = RATES[-1]
    counted, expected = false_alarms(trend, plans, most)[0], most * healthy_years(plans)
    parts += [
        f"At a stated {most:g} a year, where chance says most, {counted} come instead of {number(expected, 2)}: the "
        f"stated rate holds to a factor of {number(counted / expected, 2)}.",
        "### Noise of long tails, and with a memory",
        f"Courses of {LOGS} logs that we drew ourselves, with one regressor (`python -m benchmarks.fleet.tails`): "
        f"false alarms of {COURSES} courses without a change, and how often the 95 % interval of a change holds its "
        f"size, of {CHANGED}; sizes in standard deviations of a log.",
        tails(),
    ]
    parts += ["## One measured UR10e", *_measured(one)]
    return "\n\n".join(p for p in parts if p) + "\n"


def _size_note(plans: Sequence[FleetRobotPlan]) -> str:
    whole = 40
    if len(plans) >= whole:
        return ""
    return (
        f"The whole fleet of {whole} robots takes longer; these are its first {len(plans)}, with all its faulty ones "
        "among them."
    )


def _claims(
    outcomes: Sequence[FaultOutcome],
    bare: Sequence[FaultOutcome],
    trend: FleetTrend,
    without: FleetTrend,
    plans: Sequence[FleetRobotPlan],
) -> Iterator[Row]:
    def share(of: Sequence[FaultOutcome], name: str) -> tuple[int, str]:
        count = sum(bool(getattr(o, name)) for o in of)
        return count, f"{count} of {len(of)}"

    def word(met: bool) -> str:
        return "yes" if met else "**no**"

    count, said = share(outcomes, "found")
    yield "faults found", "≥ 95 %", said, word(count >= 0.95 * len(outcomes)), share(bare, "found")[1]
    count, said = share(outcomes, "right")
    yield (
        "right joint and effect",
        "≥ 90 %",
        said,
        word(count >= 0.9 * len(outcomes)),
        share(bare, "right")[1],
    )

    def delay(of: Sequence[FaultOutcome]) -> str:
        late = [o.delay - o.bound for o in of if o.found]
        return (
            f"{np.median([o.delay for o in of if o.found]):g} logs, {np.median(late):g} beyond the bound"
            if late
            else "–"
        )

    yield "delay, median", "beside the bound", delay(outcomes), "", delay(bare)
    rate = trend.settings.false_alarms
    expected = rate * healthy_years(plans)
    got, other = (false_alarms(t, plans, rate)[0] for t in (trend, without))
    met = word(poisson.sf(got - 1, expected) >= UNLIKELY)
    yield (
        f"false alarms at {rate:g} a robot and year",
        f"{number(expected, 2)} expected",
        str(got),
        met,
        str(other),
    )
    count, of = inside(outcomes)
    yield "sizes within their 95 % intervals", "", f"{count} of {of}", "", "{} of {}".format(*inside(bare))


def _fault_row(o: FaultOutcome) -> Row:
    unit = {
        "coulomb_friction": "N·m",
        "viscous_friction": "N·m·s/rad",
        "torque_offset": "N·m",
        "actuator_gain": "1",
    }[o.hidden.effect]
    how = f"grows in {o.hidden.growth:g} days" if o.hidden.growth else "steps"
    said = (
        with_interval(o.size, (o.size - o.half_width, o.size + o.half_width), unit)
        if np.isfinite(o.size)
        else "–"
    )
    return (
        o.robot,
        f"{o.hidden.effect.replace('_', ' ')} of {o.joint} {how}",
        o.hidden.day,
        "the same" if o.right else o.named.replace("_", " ", 1) or "nothing",
        with_interval(o.hidden.size, None, unit),
        said,
        f"{o.delay:g}",
        f"{o.bound:g}",
    )


def _false_rows(trend: FleetTrend, without: FleetTrend, plans: Sequence[FleetRobotPlan]) -> Iterator[Row]:
    for rate in RATES:
        courses, robots = false_alarms(trend, plans, rate)
        yield (
            f"{rate:g}",
            number(rate * healthy_years(plans), 2),
            courses,
            robots,
            false_alarms(without, plans, rate)[0],
        )


def _measured(one: FleetTrend | None) -> list[str]:
    if one is None:
        return ["The measured logs were not there."]
    (robot,) = one.robots
    logs = robot.courses
    answer = [f"- **{head}**: {text}" for head, text in trend_answer(one)]
    rows = (
        (
            course_words(t.course),
            with_interval(t.level, (t.level - t.half_width, t.level + t.half_width), t.course.unit),
            f"{len(t.compared)} of {len(t.course.logs)}",
            "agree" if t.agrees else "**differ**",
        )
        for t in robot.trends
        if t.course.role is not Role.JOB and len(t.compared) > 1
    )
    return [
        f"{logs.logs} logs of one arm, currents with nominal gains, the URDF alone. Nothing says when "
        "they were recorded, "
        "or how warm the joints were. `cdia fleet add` and `cdia trend` say:",
        "\n".join(answer),
        *(f"{sentence_case(s)}." for s in agreement_words(robot)),
        table(("parameter", "mean ± 95 %", "compared logs", "within their total intervals they"), rows),
        _payload(one),
    ]


def _payload(one: FleetTrend) -> str:
    """Return what the logs with and without a known weight say of it."""
    mass = next(t.course for t in one.robots[0].trends if t.course.label == "payload.mass")
    found = dict(zip(mass.logs, zip(mass.value, mass.half_width, strict=True), strict=True))
    with_it, without = found["loaded_2600g.csv"], [found[f"fourier_{n}s.csv"] for n in (40, 50)]
    base = float(np.mean([v for v, _ in without]))
    return (
        f"What changes with the job is fitted too: the log with 2.6 kg on the flange has "
        f"{with_it[0] - base:.2f} kg more "
        "at the tool than the two Fourier logs without it, so its friction can be compared with theirs."
    )
