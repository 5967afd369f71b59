"""The trace: the found effects added again one by one, the most telling first, to see the error fall."""

from __future__ import annotations

from cdia_pin.discovery.confusion import find_confusions
from cdia_pin.discovery.evidence import Evidence
from cdia_pin.discovery.experiment import rms
from cdia_pin.discovery.fitting import Whitened, refit, with_intervals
from cdia_pin.discovery.heldout import held_out_rms
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.result import Confusion, Step
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term

ITERATIONS = 2  # of the refits between the first and the last


def trace(
    problem: Problem, base: Dynamics, found: Dynamics, whitened: Whitened
) -> tuple[Dynamics, tuple[Step, ...]]:
    """Refit a found model with intervals, and say what each of its effects does to the error.

    Args:
        problem: Logs and candidates.
        base: The model that the discovery started from.
        found: The model that it ended with.
        whitened: Noise and blocks.

    Returns:
        The model at its optimum, and the steps from the base to it.
    """
    experiment, columns = problem.experiment, problem.columns
    final, evidence = refit(experiment, columns, found, whitened)
    final = with_intervals(final, evidence)
    beside = problem.beside(experiment.predict(final), whitened)
    index = {e: i for i, e in enumerate(beside.effects)}
    known = {t.label for t in base.terms}
    pending = [t for t in final.terms if t.label not in known]
    model = Dynamics(base.robot, tuple(t for t in final.terms if t.label in known))
    chosen, everything = [index[t.effect] for t in model.terms], [index[t.effect] for t in final.terms]
    steps = [step_of(problem, None, base, whitened)]
    while pending:
        best = _most_telling(beside, chosen, index, pending)
        pending.remove(best)
        chosen.append(index[best.effect])
        model = final if not pending else refit(experiment, columns, model.add(best), whitened, ITERATIONS)[0]
        confusions = find_confusions(beside, everything, index[best.effect])
        steps.append(step_of(problem, best, model, whitened, confusions))
    return final, tuple(steps)


def _most_telling(beside: Evidence, chosen: list[int], index: dict[Effect, int], pending: list[Term]) -> Term:
    gains = beside.gains(chosen)
    return max(pending, key=lambda t: gains[index[t.effect]])


def step_of(
    problem: Problem,
    term: Term | None,
    model: Dynamics,
    whitened: Whitened,
    confusions: tuple[Confusion, ...] = (),
) -> Step:
    """Return the errors of a model as a step of the trace."""
    prediction = problem.experiment.predict(model)
    fitted = rms(prediction.residual, problem.experiment.informative)
    if problem.held_out is not None:
        unseen = rms(problem.held_out.predict(model).residual, problem.held_out.informative)
    elif term is None:
        unseen = fitted  # nothing was fitted
    else:
        unseen = held_out_rms(problem.experiment, problem.columns, prediction, whitened)
    return Step(term, fitted, unseen, confusions)
