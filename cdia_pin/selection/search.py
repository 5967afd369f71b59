"""The search for the set of effects of least cost. The model is fitted and linearised again after each move."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ALWAYS, Effect, Signal, Term
from cdia_pin.progress import Progress
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import DIVERGED, Before, fitted_together, is_exact, is_possible
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.selection.evidence import Evidence, SetFit
from cdia_pin.selection.idle_drives import fitted_without_idle_drives, has_idle_drive
from cdia_pin.selection.moves import Allowed, Names, improve, names
from cdia_pin.selection.problem import WhitenedProblem
from cdia_pin.selection.replacement import promising, refitting
from cdia_pin.selection.shapes import refine_shapes
from cdia_pin.selection.simpler import simplified

Array = NDArray[np.float64]
Swaps = set[tuple[str, str]]
# Cost of an exchange at its optimum less that to first order [1], by the labels of both effects.
Errors = dict[tuple[str, str], float]

ROUGHLY = 2  # iterations of Gauss-Newton [1] after each move; the result has as many as it needs
LIKELY = 0.5  # share of what an effect explains [1] that another one must explain to first order to be tried
# Exchanges [1] that are fitted at their own optimum from one model, the best to first order. On measured logs, those
# that lowered the cost were among the first two.
MOST_REFITS = 3
MOST_MOVES = 120  # moves [1]; a guard, because the cost falls at every move
MOST_REJECTED = 6  # moves in a row [1] that the refit rejects, after which the search ends


def search(
    problem: WhitenedProblem,
    model: Dynamics,
    futile: Swaps,
    report: Progress,
    keep: Callable[[Dynamics], None] | None = None,
) -> Dynamics:
    """Add, drop and exchange effects. The model is fitted and linearised again after each move.

    A move is kept only if the cost falls at its own optimum, not just in the normal equations that proposed it. The
    search therefore cannot run in circles. A swap that failed for an effect of the torque is not tried again in any
    other set: a gain seems to replace the friction in that torque until the friction is dropped.

    Args:
        problem: Logs, candidates and noise.
        model: Model at which the search starts; its terms may be dropped.
        futile: Swaps that failed before; swaps that fail here are added.
        report: Called with what changed and the share done [1].
        keep: Called with each better model, so that an interrupted search is not lost.

    Returns:
        The model that no move improves.
    """
    # a shape depends on the other terms and on the noise
    now = _fitted_simply(problem, fitted_without_idle_drives(problem.regression, model))
    failed: set[Names] = set()
    worse: Errors = {}
    rejected = 0

    def beyond(now: Found) -> tuple[Allowed, Iterator[SetFit]]:
        """Return a test of the sets that may be tried, and the exchanges that normal equations do not show."""
        present, before = names(now.evidence, now.fit.chosen), set(now.fit.chosen)
        slight = {c for c in before if now.evidence.effects[c].plausibility.collective}

        def allowed(chosen: tuple[int, ...]) -> bool:
            tried, after = names(now.evidence, chosen), set(chosen)
            if not (slight <= after or after < before):  # no other effect can replace a collective one
                return False
            return tried not in failed and not _swaps(present, tried) & futile

        return allowed, _exchanges(problem, now, allowed, worse)

    allowed, exchanges = beyond(now)
    for moves in range(MOST_MOVES):
        if rejected == MOST_REJECTED:
            break
        better = improve(now.evidence, now.fit.chosen, allowed, most=problem.settings.most_effects)
        better = better or next(exchanges, None)
        if better is None:
            slimmer = _slimmed(problem, now)
            if slimmer is None:
                break
            now = slimmer
            allowed, exchanges = beyond(now)
            continue
        trial = _model_of(now.model, now.evidence, better.chosen, better.theta)
        report(_what_changed(now.model, trial), 1.0 - 0.9**moves)
        failed.add(names(now.evidence, better.chosen))
        grew = len(better.theta) > len(now.fit.theta)
        then = None  # most additions that are rejected would not be seen, to first order already
        if not grew or _is_seen(problem, now.errors, now.errors_with(better)):
            then = _refitted(problem, trial, _labels(now.model), _before(now, trial))
        if (
            then is None
            or has_idle_drive(then.model)
            or not then.fit.physical
            or (grew and not _is_seen(problem, now.errors, then.errors))
            or then.cost > now.cost + _sacrifice(now.evidence, now.fit, better)
        ):
            driven = {t.label for t in trial.terms if Signal.TORQUE in t.effect.traits.depends_on}
            rejected += 1
            present = names(now.evidence, now.fit.chosen)
            futile.update(s for s in _swaps(present, frozenset(_labels(trial))) if s[0] in driven)
            continue
        now, rejected = then, 0
        if keep is not None:
            keep(now.model)
        allowed, exchanges = beyond(now)
    return now.model


@dataclass(frozen=True, repr=False)
class Found:
    """A fitted model with the evidence for it.

    Attributes:
        model: The model.
        fit: Fit of its effects, which come first in its evidence.
        cost: Cost of the model as it is [1]. That of the fit is what its linearisation promises, and is lower where
            the model is not at its optimum.
        errors: RMS residual of each joint [N·m or N], shape (n,).
        problem: Logs, candidates and noise.
    """

    model: Dynamics
    fit: SetFit
    cost: float
    errors: Array
    problem: WhitenedProblem

    @cached_property
    def evidence(self) -> Evidence:
        """Evidence for its effects and all candidates. Most trials are rejected without it."""
        return self.problem.evidence(self.model)

    def errors_with(self, fit: SetFit) -> Array:
        """Return the RMS residual of each joint with other effects, to first order [N·m or N], shape (n,).

        Args:
            fit: Fit of other effects of its evidence.
        """
        prediction = self.problem.experiment.predict(self.model)
        residual, columns = prediction.residual.copy(), self.problem.problem.design.of
        robot, evidence = self.model.robot, self.evidence
        present = {t.effect: np.array(t.theta) for t in self.model.terms}
        effects = [evidence.effects[c] for c in fit.chosen]
        after = dict(zip(effects, ParameterBlocks.of(effects).split(fit.theta), strict=True))
        for effect in dict.fromkeys([*present, *after]):
            change = after.get(effect, 0.0) - present.get(effect, 0.0)
            x = columns(effect, prediction, present.get(effect))
            residual[:, list(effect.acts_on(robot))] -= x @ change
        return rms(residual, self.problem.experiment.informative)

    def __repr__(self) -> str:
        return f"Found({self.model!r}, cost {self.cost:.4g})"


def fitted(problem: WhitenedProblem, model: Dynamics) -> Found:
    """Return a model with the fit of its effects; its evidence for all candidates is formed when it is asked for.

    Args:
        problem: Logs, candidates and noise.
        model: A model at its optimum, or near it.
    """
    evidence, every = problem.evidence(model, candidates=False), range(len(model.terms))
    fit = evidence.fit(every, bodies=True)
    theta = model.theta
    left = evidence.equations.chi2(evidence.equations.columns(every), theta)
    cost = fit.cost + max(0.0, left - fit.chi2)  # parameters that are not physical yet may leave less
    return Found(model, fit, cost, problem.problem.rms(model), problem)


def _before(now: Found, trial: Dynamics) -> Before | None:
    """Return what the step to a model began with if it only adds effects; without one of them, more may be left."""
    present = {t.effect: np.array(t.theta) for t in now.model.terms}
    if not is_possible(now.model) or not present.keys() <= {t.effect for t in trial.terms}:
        return None
    theta = np.concatenate([present.get(t.effect, np.zeros(t.effect.size)) for t in trial.terms])
    return Before(theta, now.evidence.equations.objective(range(len(present)), now.model.theta))


def _refitted(
    problem: WhitenedProblem, model: Dynamics, known: Collection[str], before: Before | None = None
) -> Found | None:
    """Return a model roughly at its optimum with the evidence, or None where its fit diverges.

    Args:
        problem: Logs, candidates and noise.
        model: The model.
        known: Labels of terms whose shape stays as it is.
        before: What the step to the model began with, if it is one of a fit.
    """
    try:
        return _fitted_simply(problem, fitted_together(problem.regression, model, ROUGHLY, before), known)
    except DIVERGED:
        return None


def _fitted_simply(problem: WhitenedProblem, model: Dynamics, known: Collection[str] = ()) -> Found:
    """Return a fitted model with its best shapes, and simpler effects where its parameters reduce to them.

    Args:
        problem: Logs, candidates and noise.
        model: A model at its optimum, or near it.
        known: Labels of terms whose shape stays as it is.
    """
    found = fitted(problem, refine_shapes(problem.regression, model, known=known))
    plainer = simplified(found.model)
    if found.fit.physical or plainer is found.model:
        return found
    return fitted(problem, fitted_together(problem.regression, plainer, ROUGHLY))


def _exchanges(problem: WhitenedProblem, now: Found, allowed: Allowed, worse: Errors) -> Iterator[SetFit]:
    """Yield better sets in which a nonlinear effect, fitted at its own optimum, replaces another effect.

    An exchange that failed is tried again only if it promises more than it did before by as much as it then lacked.
    """
    evidence = now.evidence
    pairs: list[tuple[float, tuple[int, ...], int, tuple[str, str]]] = []
    for one in now.fit.chosen:
        rest = tuple(c for c in now.fit.chosen if c != one)
        left = evidence.free_chi2(rest)
        enough = LIKELY * (left - now.fit.chi2)

        def if_not_linear(effect: Effect, enough: float = enough) -> float:
            return np.inf if is_exact(effect) else enough

        for other, gain in promising(evidence, rest, if_not_linear):
            if other != one:
                change = left - gain - now.fit.chi2 + evidence.penalty[other] - evidence.penalty[one]
                pairs.append((float(change), rest, other, (evidence.labels[other], evidence.labels[one])))
    at_optimum = refitting(problem, now.model, evidence)
    tried = (
        (change, rest, other, swap)
        for change, rest, other, swap in sorted(pairs)
        if allowed((*rest, other)) and change + worse.get(swap, -np.inf) < -evidence.criterion.margin
    )
    for change, rest, other, swap in islice(tried, MOST_REFITS):
        fit = at_optimum(rest, other)
        if fit.physical and fit.cost < now.fit.cost - evidence.criterion.margin:
            yield fit
        else:
            worse[swap] = fit.cost - now.fit.cost - change if fit.physical else np.inf


def _slimmed(problem: WhitenedProblem, now: Found) -> Found | None:
    """Return a model without an effect that only corrects the shape of another effect on its joint, or None."""
    evidence = now.evidence
    lost = {
        evidence.effects[c]: evidence.free_chi2([x for x in now.fit.chosen if x != c]) - now.fit.chi2
        for c in now.fit.chosen
    }
    shaped = [e for e in lost if e.shape]
    for effect, gain in lost.items():
        if not any(set(effect.scope) & set(e.scope) and gain < lost[e] for e in shaped):
            continue
        others = now.model.remove(effect.label)
        elsewhere = [t.label for t in others.terms if not set(t.effect.scope) & set(effect.scope)]
        then = _refitted(problem, others, elsewhere)
        if then is not None and then.fit.physical and then.cost < now.cost - evidence.criterion.margin:
            return then
    return None


def _is_seen(problem: WhitenedProblem, before: Array, after: Array) -> bool:
    """Return True if the RMS of some joint falls visibly, by a torque that matters there."""
    fallen = np.sqrt(np.maximum(before**2 - after**2, 0.0))
    lower = after < (1 - problem.settings.criterion.least_fall) * before
    return bool((lower & (fallen > problem.problem.smallest_torque)).any())


def _sacrifice(evidence: Evidence, now: SetFit, after: SetFit) -> float:
    """Return the cost that a move may add [1]: none, or the least gain of an effect that is dropped."""
    dropped = set(now.chosen) - set(after.chosen)
    if not now.physical:
        return float("inf")
    return (
        max((evidence.least_gain[c] for c in dropped), default=0.0)
        if set(after.chosen) < set(now.chosen)
        else -1e-6
    )


def _swaps(before: Names, after: Names) -> Swaps:
    """Return the pairs of an added and a dropped effect."""
    return {(new, old) for new in after - before for old in before - after}


def _labels(model: Dynamics) -> list[str]:
    return [t.label for t in model.terms]


def _what_changed(before: Dynamics, after: Dynamics) -> str:
    had, has = set(_labels(before)), set(_labels(after))
    return ", ".join([*(f"+ {x}" for x in sorted(has - had)), *(f"− {x}" for x in sorted(had - has))])


def _model_of(model: Dynamics, evidence: Evidence, chosen: Sequence[int], theta: Array) -> Dynamics:
    profiles = {t.effect: t.profile for t in model.terms}
    effects = [evidence.effects[c] for c in chosen]
    terms = []
    for effect, part in zip(effects, ParameterBlocks.of(effects).split(theta), strict=True):
        terms.append(Term(effect, tuple(float(v) for v in part), profiles.get(effect, ALWAYS)))
    return Dynamics(model.robot, tuple(terms))
