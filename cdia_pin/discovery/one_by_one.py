"""Found effects are added again one by one, and each model is judged by blocks of time that it did not see."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.regression.cross_validation import held_out_rms
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.regression.shares import mean_share
from cdia_pin.selection.problem import WhitenedProblem

ITERATIONS = 2  # iterations of Gauss-Newton [1] for the models between the first and the last


@dataclass(frozen=True)
class Added:
    """A model with one more effect.

    Attributes:
        label: Label of the effect; empty for the first model.
        model: The model, roughly at its optimum.
        error: Its relative held-out RMS residual, mean over the joints [1]; of the first model that of the base.
    """

    label: str
    model: Dynamics
    error: float


def kept(
    problem: WhitenedProblem, base: Dynamics, found: Dynamics, forced: Collection[str] = ()
) -> list[Added]:
    """Return the model without the effects that were found, and one more for each effect that is worth keeping.

    An effect is left out if it raises the held-out error beside those before it and beside all others. Where the last
    model predicts worse than an earlier one, those after the best stay only if they lower the error step by step.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
        forced: Labels of effects that stay in any case.
    """
    terms, whole = _ordered(problem, base, found), heldout_error(problem, found)

    def helps_at_last(term: Term) -> bool:
        return whole < _fitted(problem, term.label, found.remove(term.label)).error

    first = _without_found(problem, base, found)
    models = _added(problem, found, first, terms, lambda t: t.label in forced or helps_at_last(t))
    best = min(range(len(models)), key=lambda k: models[k].error)
    if is_no_worse(problem, models[-1].error, models[best].error):
        return models
    seen = {m.label for m in models[: best + 1]}
    rest = [t for t in terms if t.label not in seen]
    return [*models[:best], *_added(problem, found, models[best], rest, lambda t: t.label in forced)]


def _without_found(problem: WhitenedProblem, base: Dynamics, found: Dynamics) -> Added:
    """Return a found model without the effects that were added, with the error of the base and all its effects."""
    known = {t.label for t in base.terms}
    return Added("", _part(found, known), heldout_error(problem, base))


def _ordered(problem: WhitenedProblem, base: Dynamics, found: Dynamics) -> list[Term]:
    """Return the terms that were found; each explains most after those before it."""
    known = {t.label for t in base.terms}
    beside = problem.evidence(found, candidates=False)
    index = {e: i for i, e in enumerate(beside.effects)}
    chosen = [index[t.effect] for t in found.terms if t.label in known]
    pending, out = [t for t in found.terms if t.label not in known], []
    while pending:
        gains = beside.gains(chosen)
        best = max(pending, key=lambda t: gains[index[t.effect]])
        pending.remove(best)
        chosen.append(index[best.effect])
        out.append(best)
    return out


def _added(
    problem: WhitenedProblem,
    found: Dynamics,
    first: Added,
    terms: Sequence[Term],
    stays: Callable[[Term], bool],
) -> list[Added]:
    """Return a first model, and those with one term more each; a term that raises the error stays only if told to.

    Effects of the torque have several optima. A fit that begins at the model before may end in another one than the
    search, and then predicts much worse. So where the error rises, and at the end, a fit that begins at the found model
    is tried too.
    """
    models = [first]
    for term in terms:
        added = models[-1].model.add(term)
        trial = _fitted(problem, term.label, added)
        if not is_no_worse(problem, trial.error, models[-1].error):
            trial = _better(problem, found, trial)
        if is_no_worse(problem, trial.error, models[-1].error) or stays(term):
            models.append(trial)
    if len(models) > 1:
        models[-1] = _better(problem, found, models[-1])
    return models


def _better(problem: WhitenedProblem, found: Dynamics, now: Added) -> Added:
    """Return the better of a model and a fit of the same effects that begins at the found model."""
    part = _part(found, {t.label for t in now.model.terms})
    return min(now, _fitted(problem, now.label, part), key=lambda m: m.error)


def _fitted(problem: WhitenedProblem, label: str, start: Dynamics) -> Added:
    """Return a model roughly at its optimum with its held-out error; the iteration starts at its parameters."""
    model = fitted_together(problem.regression, start, ITERATIONS)
    return Added(label, model, heldout_error(problem, model))


def _part(found: Dynamics, labels: Collection[str]) -> Dynamics:
    """Return a found model with some of its effects, at its parameters."""
    return replace(found, terms=tuple(t for t in found.terms if t.label in labels))


def is_no_worse(problem: WhitenedProblem, error: float, other: float) -> bool:
    """Tell whether an error is at most another one, or above it by no more than an effect may raise it.

    Args:
        problem: Its criterion says how much that is.
        error: Relative error [1].
        other: Relative error [1].
    """
    return error <= other * (1 + problem.settings.criterion.most_harm)


def heldout_error(problem: WhitenedProblem, model: Dynamics) -> float:
    """Return the relative RMS residual on blocks of time that were not fitted, mean over the joints [1].

    All terms of the model are fitted again without each block.

    Args:
        problem: Logs, candidates and noise.
        model: The model, roughly at its optimum.
    """
    experiment = problem.experiment
    error = held_out_rms(problem.regression, experiment.predict(model))
    return mean_share(error, rms(experiment.measured, experiment.informative))
