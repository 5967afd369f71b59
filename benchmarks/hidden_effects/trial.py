"""One case from beginning to end: make the run, ask `discover` what is missing, hold its answer against the truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from benchmarks.hidden_effects.case import Case
from benchmarks.hidden_effects.drawing import drawn, recorded
from benchmarks.hidden_effects.oracle import noise_floor, sights, unordered
from benchmarks.hidden_effects.outcome import Outcome
from benchmarks.hidden_effects.resolving import resolved
from benchmarks.hidden_effects.truth import label_of, true_model
from cdia_pin.discovery import Discovery, compare, discover
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term

HELD_OUT = 18.0  # [s], of the motion that is only predicted
SMALLEST = 0.05  # parameters below this share of an effect's largest are no measure of relative error


def run_case(case: Case) -> Outcome:
    """Run a case."""
    plant, scenario = drawn(case)
    log = recorded(case, plant, scenario)
    began = perf_counter()
    found = discover(Dynamics(plant.robot), log)
    seconds = perf_counter() - began
    true = true_model(plant, scenario.faults)
    seen, ratio = (), np.array([np.nan])
    if true is not None:
        seen = sights(true, scenario.faults, log) if scenario.faults else ()
        later = recorded(case, plant, replace(scenario.holdout(), duration=min(HELD_OUT, scenario.duration)))
        ratio = compare(found.model, later).rms / noise_floor(true, later)
    again = resolved(plant, scenario, log, found) if any(s.confusable for s in seen) else None
    right = list(_right(found, true)) if true is not None else []
    return Outcome(
        id=case.id,
        suite=case.suite,
        arm=case.arm,
        noise=case.noise,
        excitation=case.excitation,
        shares=case.shares,
        hidden=tuple(map(label_of, scenario.faults))
        if true is not None
        else tuple(map(str, scenario.faults)),
        found=_labels(found),
        confusable=tuple(dict.fromkeys(_confusable(found))),
        verdict=found.verdict,
        structure_left=found.structure_left,
        sights=seen,
        over_floor=float(np.max(ratio)),
        mean_over_floor=float(np.sqrt(np.mean(ratio**2))),
        parameter_errors=tuple(e for estimate, truth in right for e in _errors(estimate, truth)),
        covered=tuple(c for estimate, truth in right for c in _covered(estimate, truth)),
        resolved=_labels(again) if again else None,
        seconds=seconds,
    )


def _labels(found: Discovery) -> tuple[str, ...]:
    return tuple(s.term.label for s in found.steps if s.term)


def _confusable(found: Discovery) -> Iterator[str]:
    for step in found.steps:
        yield from (" + ".join(e.label for e in c.effects) for c in step.confusions)


def _right(found: Discovery, true: Dynamics) -> Iterator[tuple[Term, Term]]:
    """Yield the terms that were rightly named, each beside the true one."""
    truth = {unordered(t.label): t for t in true.terms}
    for step in found.steps:
        if step.term and (same := truth.get(unordered(step.term.label))):
            yield step.term, same


def _errors(estimate: Term, truth: Term) -> Sequence[float]:
    given, known = np.array(estimate.theta), np.array(truth.theta)
    counted = np.abs(known) > SMALLEST * np.abs(known).max()
    return (np.abs(given - known)[counted] / np.abs(known)[counted]).tolist()


def _covered(estimate: Term, truth: Term) -> Iterator[bool]:
    for (low, high), value in zip(estimate.ci95 or (), truth.theta, strict=False):
        yield bool(low <= value <= high)
