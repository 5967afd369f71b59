"""The search for the set of effects of least cost, refitting and differentiating anew after each move."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Signal, Term
from cdia_pin.regression.fitting import Whitened, is_exact, refit
from cdia_pin.selection.evidence import Evidence, Fit
from cdia_pin.selection.moves import MARGIN, Names, improve, names
from cdia_pin.selection.problem import Problem
from cdia_pin.selection.refits import promising, refitting
from cdia_pin.selection.shapes import refine_shapes

Array = NDArray[np.float64]
Progress = Callable[[str, float], None]
Swaps = set[tuple[str, str]]
Allowed = Callable[[tuple[int, ...]], bool]

ROUGHLY = 2  # iterations of a refit while searching
VISIBLE = 0.04  # share by which an additional effect must lower the RMS of some joint, as a user sees it
LIKELY = 0.5  # share of what an effect explains that another must, to first order, to be tried as it is
MOST_REFITS = 8  # exchanges that are tried so from one model, those best to first order
NEARBY = 5  # iterations of such a trial
MOST_MOVES = 120
MOST_REJECTED = 6  # moves in a row that did not hold what they promised


def search(problem: Problem, model: Dynamics, whitened: Whitened, futile: Swaps, tell: Progress) -> Dynamics:
    """Add, drop and exchange effects, refitting and differentiating anew after each move.

    A move is kept only if the cost falls at its own optimum, not just in the normal equations that proposed it, so
    that the search cannot turn in circles. A swap that failed for an effect of the torque is not tried again, in
    whatever company: a gain seems able to replace the friction in that torque, until the friction is gone.

    Args:
        problem: Logs and candidates.
        model: Where the search starts; its terms may be dropped.
        whitened: Noise and blocks.
        futile: Swaps that failed before; those that fail here are added.
        tell: Called with what changed and the share done.

    Returns:
        The model that no move improves.
    """
    experiment, columns = problem.experiment, problem.columns
    model, _ = refit(experiment, columns, model, whitened)
    # beside the others, and in the noise known by now
    now = fitted(problem, refine_shapes(experiment, columns, model, whitened), whitened)
    failed: set[Names] = set()
    rejected = 0

    def beyond(now: Found) -> tuple[Allowed, Iterator[Fit]]:
        """Return which sets may be tried from a model, and exchanges that normal equations do not show."""
        present, before = names(now.evidence, now.fit.chosen), set(now.fit.chosen)
        slight = {c for c in before if now.evidence.effects[c].plausibility.collective}

        def allowed(chosen: tuple[int, ...]) -> bool:
            tried, after = names(now.evidence, chosen), set(chosen)
            if not (slight <= after or after < before):  # it stands for many, which no other does
                return False
            return tried not in failed and not _swaps(present, tried) & futile

        return allowed, _exchanges(problem, now, whitened, allowed)

    allowed, exchanges = beyond(now)
    for moves in range(MOST_MOVES):
        if rejected == MOST_REJECTED:
            break
        better = improve(now.evidence, now.fit.chosen, allowed, most=problem.settings.most_effects)
        better = better or next(exchanges, None)
        if better is None:
            slimmer = _slimmed(problem, now, whitened)
            if slimmer is None:
                break
            now = slimmer
            allowed, exchanges = beyond(now)
            continue
        trial = _model_of(now.model, now.evidence, better.chosen, better.theta)
        tell(_what_changed(now.model, trial), 1.0 - 0.9**moves)
        failed.add(names(now.evidence, better.chosen))
        trial, _ = refit(experiment, columns, trial, whitened, ROUGHLY)
        trial = refine_shapes(experiment, columns, trial, whitened, known=_labels(now.model))
        then = fitted(problem, trial, whitened)
        grew = len(then.fit.theta) > len(now.fit.theta)
        if (
            not then.fit.physical
            or (grew and not _is_seen(problem, now.errors, then.errors))
            or then.fit.cost > now.fit.cost + _sacrifice(now.evidence, now.fit, better)
        ):
            driven = {t.label for t in trial.terms if Signal.TORQUE in t.effect.traits.depends_on}
            rejected += 1
            present = names(now.evidence, now.fit.chosen)
            futile.update(s for s in _swaps(present, frozenset(_labels(trial))) if s[0] in driven)
            continue
        now, rejected = then, 0
        allowed, exchanges = beyond(now)
    return now.model


@dataclass(frozen=True)
class Found:
    """A model, the normal equations of its effects and all candidates around it, its fit in them and its errors."""

    model: Dynamics
    evidence: Evidence
    fit: Fit
    errors: Array


def fitted(problem: Problem, model: Dynamics, whitened: Whitened) -> Found:
    """Return a model, which is at its optimum, with the normal equations of all candidates around it."""
    evidence = problem.beside(problem.experiment.predict(model), whitened)
    fit = evidence.fit(_indices(evidence, model), bodies=True)
    return Found(model, evidence, fit, problem.rms(model))


def _exchanges(problem: Problem, now: Found, whitened: Whitened, allowed: Allowed) -> Iterator[Fit]:
    """Yield better sets in which a large effect that is not linear, seen only at its own optimum, replaces another."""
    evidence = now.evidence
    pairs: list[tuple[float, tuple[int, ...], int]] = []
    for one in now.fit.chosen:
        rest = tuple(c for c in now.fit.chosen if c != one)
        left = evidence.free_chi2(rest)
        enough = LIKELY * (left - now.fit.chi2)

        def if_not_linear(effect: Effect, enough: float = enough) -> float:
            return np.inf if is_exact(effect) else enough

        for other, gain in promising(evidence, rest, if_not_linear):
            if other != one:
                cost = left - gain + evidence.price[other] - evidence.price[one]
                pairs.append((float(cost), rest, other))
    at_optimum = refitting(problem, now.model, whitened, evidence, NEARBY)
    tried = ((rest, other) for _, rest, other in sorted(pairs) if allowed((*rest, other)))
    for rest, other in islice(tried, MOST_REFITS):
        fit = at_optimum(rest, other)
        if fit.physical and fit.cost < now.fit.cost - MARGIN:
            yield fit


def _slimmed(problem: Problem, now: Found, whitened: Whitened) -> Found | None:
    """Return a model without an effect that stands for what the shape of another on its joint is wrong by."""
    evidence = now.evidence
    lost = {
        evidence.effects[c]: evidence.free_chi2([x for x in now.fit.chosen if x != c]) - now.fit.chi2
        for c in now.fit.chosen
    }
    shaped = [e for e in lost if e.shape]
    for effect, worth in lost.items():
        if not any(set(effect.scope) & set(e.scope) and worth < lost[e] for e in shaped):
            continue
        others = now.model.remove(effect.label)
        trial, _ = refit(problem.experiment, problem.columns, others, whitened, ROUGHLY)
        then = fitted(problem, refine_shapes(problem.experiment, problem.columns, trial, whitened), whitened)
        if then.fit.physical and then.fit.cost < now.fit.cost - MARGIN:
            return then
    return None


def _is_seen(problem: Problem, before: Array, after: Array) -> bool:
    """Tell whether a user would see the RMS of some joint fall, by a torque that matters there."""
    fallen = np.sqrt(np.maximum(before**2 - after**2, 0.0))
    return bool(((after < (1 - VISIBLE) * before) & (fallen > problem.smallest_torque)).any())


def _sacrifice(evidence: Evidence, now: Fit, after: Fit) -> float:
    """Return the cost that a move may add: none, or what an effect that is dropped would have had to earn."""
    dropped = set(now.chosen) - set(after.chosen)
    if not now.physical:
        return float("inf")
    return (
        max((evidence.least_gain[c] for c in dropped), default=0.0)
        if set(after.chosen) < set(now.chosen)
        else -1e-6
    )


def _swaps(before: Names, after: Names) -> Swaps:
    """Return which effect came for which."""
    return {(new, old) for new in after - before for old in before - after}


def _indices(evidence: Evidence, model: Dynamics) -> list[int]:
    present = {t.effect for t in model.terms}
    return [i for i, e in enumerate(evidence.effects) if e in present]


def _labels(model: Dynamics) -> list[str]:
    return [t.label for t in model.terms]


def _what_changed(before: Dynamics, after: Dynamics) -> str:
    had, has = set(_labels(before)), set(_labels(after))
    return ", ".join([*(f"+ {x}" for x in sorted(has - had)), *(f"− {x}" for x in sorted(had - has))])


def _model_of(model: Dynamics, evidence: Evidence, chosen: Sequence[int], theta: Array) -> Dynamics:
    profiles = {t.effect: t.profile for t in model.terms}
    terms, at = [], 0
    for c in chosen:
        effect = evidence.effects[c]
        values = tuple(float(v) for v in theta[at : at + effect.size])
        term = Term(effect, values)
        terms.append(replace(term, profile=profiles[effect]) if effect in profiles else term)
        at += effect.size
    return Dynamics(model.robot, tuple(terms))
