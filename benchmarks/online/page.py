"""The page docs/results-online.md, from outcomes and cost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.claim_tables import MUST_SHOW, by_part, targets
from benchmarks.claims import met
from benchmarks.markdown import Row, details, table
from benchmarks.online.claims import PARTS, fell_short
from benchmarks.online.cost import ARM, Cost
from benchmarks.online.outcome import Outcome
from benchmarks.online.scenarios import BEGIN
from benchmarks.online.trial import LEARNED_FROM, SEED
from benchmarks.publishing import made_by
from cdia_pin.diagnosis import MonitorSettings

DEAREST = {"healthy": 2.5, "watching": 4.0, "accommodating, with correct": 6.0}  # tick over floor [1]
SLOWEST = 10.0  # 99.9th percentile of a tick over the floor [1]
LEAST_LOOP = 25.0  # time of the arm over that of the clock, of a closed loop [1]
LONGEST_STUDY = 30.0  # [s]

PACKAGES = ("pin", "mujoco", "numba", "numpy")  # whose versions matter


def page(outcomes: Sequence[Outcome], cost: Cost | None, command: str, quick: bool) -> str:
    """Return the results as Markdown."""
    arms = list(dict.fromkeys(o.robot for o in outcomes))
    rows = [*targets(PARTS, outcomes), *(_ticks(cost) if cost is not None else ())]
    parts = [_head(command, quick, outcomes), "## Must show", table(MUST_SHOW, rows)]
    parts += by_part(PARTS, outcomes, arms, lambda o: o.robot)
    if cost is not None:
        parts += _cost_part(cost)
    parts += ["## Where it falls short", *_failures(outcomes)]
    return "\n\n".join(parts) + "\n"


def _head(command: str, quick: bool, outcomes: Sequence[Outcome]) -> str:
    sample = "**A quick sample of the cases, not the results.** " if quick else ""
    settings, minutes = MonitorSettings(), sum(o.minutes for o in outcomes)
    runs = f"{len(outcomes)} runs, {minutes:.0f} minutes of simulated motion. " if outcomes else ""
    return (
        "# Results of the monitor\n\n"
        f"{sample}{made_by(command, PACKAGES)}\n\n"
        f"{runs}The arm is MuJoCo's, whose masses, centres and inertias are up to 3 % wrong (seed {SEED}); "
        "positions have 18 bit, velocities a noise of 10⁻³ rad/s, 1 kHz; the control law is computed torque "
        "of the file's model, and the monitor is in the loop. It has learned from "
        f"{LEARNED_FROM} healthy minutes on other motions and has its default settings (γ up to "
        f"{settings.bandwidth:g}/s). Faults begin at {BEGIN:g} s; a share is the RMS of the fault's torque over that "
        "of its joint's. Motions and noise "
        "are seeded by the cases' names (`benchmarks/online/scenarios.py`). Where two faults are the same torque "
        "(an offset and a spring with preload), either name is right."
    )


# ---------------------------------------------------------------- figures


def _ticks(cost: Cost) -> Iterator[Row]:
    for t in cost.ticks:
        text = f"Cost of a tick, {t.state}, {t.effects} known effects, over that of the rigid body"
        most = DEAREST[t.state]
        yield (text, f"≤ {most:g}", f"{t.ratio:.1f}", "", met(t.ratio <= most))
        yield (
            f"{text}: 99.9 % of the ticks",
            f"≤ {SLOWEST:g}",
            f"{t.slowest:.1f}",
            "",
            met(t.slowest <= SLOWEST),
        )
    for name, factor in cost.loops.items():
        text = f"Closed loop of plant, control and monitor, {name}: times real time"
        yield (text, f"≥ {LEAST_LOOP:g}", f"{factor:.1f}", "", met(factor >= LEAST_LOOP))
    text = "Both studies of the thesis, s"
    yield (text, f"≤ {LONGEST_STUDY:g}", f"{cost.study:.0f}", "", met(cost.study <= LONGEST_STUDY))


def _cost_part(cost: Cost) -> Iterator[str]:
    yield "## Cost"
    yield (
        f"{ARM}, one core. The floor is `crba` and `nonLinearEffects` of the same arm on the same samples, called in a "
        "loop; ratios are medians over seconds of a run in which both loops took turns."
    )
    rows = [
        (
            t.effects,
            t.state,
            f"{t.microseconds:.1f}",
            f"{t.floor:.2f}",
            f"{t.ratio:.1f}",
            f"≤ {DEAREST[t.state]:g}",
            f"{t.slowest:.1f}",
        )
        for t in cost.ticks
    ]
    yield table(
        (
            "known effects",
            "monitor is",
            "µs per tick",
            "floor, µs",
            "ratio",
            "target",
            "99.9 %, over the floor",
        ),
        rows,
    )
    decisions = [
        (f"decision over all 2^{n} combinations", f"{us:.0f} µs") for n, us in cost.decisions.items()
    ]
    numba = "loads numba" if cost.loads_numba else "does not load numba"
    yield table(
        ("", "time"),
        [
            *decisions,
            ("`import cdia_pin`", f"{1e3 * cost.package:.0f} ms"),
            (f"`from cdia_pin.diagnosis import Monitor`, which {numba}", f"{1e3 * cost.diagnosis:.0f} ms"),
            ("program that makes a monitor, start to end, nothing compiled before", f"{cost.first:.1f} s"),
            ("the same, compiled before", f"{cost.second:.1f} s"),
            *((f"a second of a closed loop, {name}", f"{1e3 / f:.0f} ms") for name, f in cost.loops.items()),
            ("both studies of the thesis", f"{cost.study:.0f} s"),
        ],
    )


# ---------------------------------------------------------------- failures


def _failures(outcomes: Sequence[Outcome]) -> Iterator[str]:
    yield "Every case that is not what was hoped for, with what the monitor said."
    for part in PARTS:
        if part.title.startswith("Of these"):
            continue
        rows = [
            (f"`{o.id}`", "; ".join(dict.fromkeys(why)), "; ".join(o.said) or "nothing")
            for o in outcomes
            if part.chosen(o) and (why := fell_short(o))
        ]
        if rows:
            total = sum(part.chosen(o) for o in outcomes)
            yield details(f"{part.title}: {len(rows)} of {total}", table(("case", "", "said"), rows))
