"""Found effects are added again one by one, and each model is judged by blocks of time that it did not see."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

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
        error: Its relative held-out RMS residual, mean over the joints [1].
    """

    label: str
    model: Dynamics
    error: float


def before(problem: WhitenedProblem, base: Dynamics, found: Dynamics) -> Added:
    """Return a found model without the effects that were added.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
    """
    known = {t.label for t in base.terms}
    model = Dynamics(base.robot, tuple(t for t in found.terms if t.label in known))
    return Added("", model, heldout_error(problem, base))


def ordered(problem: WhitenedProblem, base: Dynamics, found: Dynamics) -> list[Term]:
    """Return the terms that were found; each explains most after those before it.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
    """
    known = {t.label for t in base.terms}
    beside = problem.evidence(found)
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


def added(
    problem: WhitenedProblem, first: Added, terms: Sequence[Term], stays: Callable[[Term], bool]
) -> Iterator[Added]:
    """Yield models with one term after another, without terms that raise the held-out error.

    Args:
        problem: Logs, candidates and noise.
        first: The model without them.
        terms: The terms, in their order.
        stays: Tells whether a term that raises the error stays all the same.
    """
    now = first
    for term in terms:
        trial = fitted_together(problem.regression, now.model.add(term), ITERATIONS)
        error = heldout_error(problem, trial)
        if is_no_worse(problem, error, now.error) or stays(term):
            now = Added(term.label, trial, error)
            yield now


def is_no_worse(problem: WhitenedProblem, error: float, other: float) -> bool:
    """Tell whether an error is below another one, or above it by no more than an effect may raise it.

    Args:
        problem: Its criterion says how much that is.
        error: Relative error [1].
        other: Relative error [1].
    """
    return error < other * (1 + problem.settings.criterion.most_harm)


def heldout_error(problem: WhitenedProblem, model: Dynamics) -> float:
    """Return the relative RMS residual on blocks of time that were not fitted, mean over the joints [1].

    Args:
        problem: Logs, candidates and noise.
        model: The model, roughly at its optimum.
    """
    experiment = problem.experiment
    error = held_out_rms(problem.regression, experiment.predict(model))
    return mean_share(error, rms(experiment.measured, experiment.informative))
