"""One case from beginning to end: draw the effect, put it in, ask, and hold the answer against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import hypot
from time import process_time

from benchmarks.real_residuals.answers import Named, label_of
from benchmarks.real_residuals.bases import Base, BaseCase
from benchmarks.real_residuals.cases import KNOWN, UNCHANGED, Case
from benchmarks.real_residuals.draws import drawn
from benchmarks.real_residuals.failures import failed
from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.flows import FLOW, NEEDS_AFTER, NEEDS_BEFORE, Question
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.outcome import Outcome
from benchmarks.real_residuals.running import store_of
from benchmarks.real_residuals.sizing import NoSizeError, telling
from benchmarks.real_residuals.variants import varied
from cdia_pin.effects import Term
from cdia_pin.logs import Log

RIPPLE = (
    "position_ripple"  # its sine and cosine mean nothing without its frequency: its size is its amplitude
)


@dataclass(frozen=True)
class Truth:
    """What differs between two logs.

    Attributes:
        label: Its name; empty if nothing differs.
        values: Its parameters that tell how large it is.
    """

    label: str = ""
    values: Mapping[str, float] | None = None


def run_case(case: Case) -> Outcome:
    """Run a case."""
    outcome = Outcome(
        case.id, case.plain, case.draw, case.pair.arm, case.effect, case.size, case.flow, case.variant
    )
    try:
        before, after, truth = logs_of(case)
    except NoSizeError as why:
        return replace(outcome, impossible=str(why))
    outcome, began = replace(outcome, truth=truth.label), process_time()
    try:
        first, second = (varied(log, case.variant) for log in (before, after))
        question = Question(case.pair.before.robot, first, second, *_bases(case))
        began = process_time()
        answer = FLOW[case.flow](question)
    except BaseException as why:  # a solver may panic, which is no Exception
        return replace(outcome, failure=failed(why), seconds=process_time() - began)
    said = replace(outcome, named=answer.named, verdict=answer.verdict, seconds=answer.seconds)
    found = next((n for n in answer.named if n.label == truth.label), None)
    return judged(said, found, truth.values) if found and truth.values else said


def logs_of(case: Case) -> tuple[Log, Log, Truth]:
    """Return both logs of a case, the second with its effect, and what differs.

    Raises:
        NoSizeError: If the effect can have its size on no joint.
    """
    before, after = case.pair.before.read(), case.pair.after.read()
    if case.effect == UNCHANGED:
        return before, after, Truth()
    if case.effect == KNOWN:
        return before, after, Truth("payload", dict(case.pair.known))
    robot = case.pair.before.robot
    first, second = FilteredLog.of(before, robot), FilteredLog.of(after, robot)
    term = drawn(case.effect, case.size / 100, first, second, case.seed)
    return before, Insertion(term, second).into(after), truth_of(term, second)


def judged(outcome: Outcome, found: Named, truth: Mapping[str, float]) -> Outcome:
    """Return an outcome with the errors of the parameters of what was rightly named.

    Args:
        outcome: Without them.
        found: What was named.
        truth: True parameters that tell the size.
    """
    errors, held = misses(found, truth)
    intervals = {k: found.intervals[k] for k in held}
    widths = {k: (high - low) / 2 / abs(truth[k]) for k, (low, high) in intervals.items()}
    return replace(outcome, errors=errors, held=held, widths=widths)


def misses(found: Named, truth: Mapping[str, float]) -> tuple[dict[str, float], dict[str, bool]]:
    """Return by how much each parameter misses the true one [1], and whether its interval holds it.

    Args:
        found: What was named.
        truth: True parameters that tell the size.
    """
    values = _amplitude(found.values) if found.effect == RIPPLE else found.values
    there = {k: v for k, v in truth.items() if k in values and v != 0}
    intervals = {k: found.intervals[k] for k in there if k in found.intervals}
    errors = {k: abs(values[k] / v - 1.0) for k, v in there.items()}
    return errors, {k: low <= truth[k] <= high for k, (low, high) in intervals.items()}


def truth_of(term: Term, along: FilteredLog) -> Truth:
    """Return the name of an effect that is put into a log, and its parameters that tell how large it is.

    Args:
        term: The effect with its numbers.
        along: The log without it.
    """
    entry = {"effect": term.effect.name, "joints": term.effect.joints(along.robot)}
    return Truth(label_of(entry, along.robot), _values(term, along))


def _values(term: Term, along: FilteredLog) -> dict[str, float]:
    if term.effect.name == RIPPLE:
        return _amplitude(term.values)
    return {name: term.values[name] for name in telling(term, along)}


def _amplitude(values: Mapping[str, float]) -> dict[str, float]:
    return {"amplitude": hypot(values.get("sine", 0.0), values.get("cosine", 0.0))}


def _bases(case: Case) -> tuple[Base | None, Base | None]:
    if case.flow not in (*NEEDS_BEFORE, *NEEDS_AFTER):
        return None, None
    kept = store_of("bases", Base.from_json).read()
    before = _found(kept, BaseCase(case.pair.before).id) if case.flow in NEEDS_BEFORE else None
    after = _found(kept, BaseCase(case.pair.after).id) if case.flow in NEEDS_AFTER else None
    return before, after


def _found(kept: Mapping[str, Base], name: str) -> Base:
    """Return what was found in an untouched log; a program that fails there has no model to begin with."""
    base = kept[name]
    if base.failure:
        raise ValueError(f"no model of {name}: {base.failure}")
    return base
