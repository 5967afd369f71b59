"""The addition of one effect on request, without a test of the evidence for it."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.discovery.conclusion import concluded
from cdia_pin.discovery.discovery_result import Discovery
from cdia_pin.discovery.repetition import contained_terms
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Expression, Term, Unknown
from cdia_pin.errors import EffectError
from cdia_pin.logs.log import Log, listed
from cdia_pin.progress import Progress, silent
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.gauss_newton import fitted_together, refit
from cdia_pin.regression.regression import Regression
from cdia_pin.selection.candidates import per_log
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem
from cdia_pin.selection.shapes import refine_shapes
from cdia_pin.threads import on_one_thread


@on_one_thread
def add_effect(
    model: Dynamics,
    effect: Effect,
    logs: Log | Sequence[Log],
    *,
    holdout: Log | Sequence[Log] | None = None,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
) -> Discovery:
    """Add one effect to a model and fit the whole model to logs, without a test of the evidence for the effect.

    Args:
        model: The model; a term of the same effect and scope is replaced, and so is one whose torque in these logs is
            part of the effect's, such as Coulomb friction where Stribeck friction is added.
        effect: The effect to add; its shape is fitted too.
        logs: One log or several.
        holdout: Logs that are only predicted.
        settings: How logs are conditioned.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        A discovery whose trace has two steps, before and after.

    Raises:
        LogError: If a log is too short or of other joints.
        EffectError: If the effect cannot be seen in these logs, or if its torque in them is that of terms of the model.
    """
    report = progress or silent
    report("conditioning", 0.0)
    problem = Problem.of(model, listed(logs), listed(holdout), settings or DiscoverySettings())
    return add_effect_in(problem, model, effect, report)


def add_effect_in(
    problem: Problem, model: Dynamics, effect: Effect, progress: Progress | None = None
) -> Discovery:
    """Add one effect as `add_effect` does, to logs that are already conditioned.

    Args:
        problem: The logs, and the candidates for the model.
        model: The model.
        effect: The effect to add.
        progress: Called with a sentence and the share done, from 0 to 1.

    Raises:
        EffectError: If the effect cannot be seen in these logs, or if its torque in them is that of terms of the model.
    """
    report = progress or silent
    report("estimating the noise", 0.1)
    (effect,) = per_log([effect], problem.experiment, problem.settings.per_log)
    problem = problem.without_rest_of([effect, *(t.effect for t in model.terms)])
    whitened = problem.with_first_noise(model)
    report(f"fitting {effect.label}", 0.3)
    base = model.remove(effect.label) if effect.label in {t.label for t in model.terms} else model
    along = problem.experiment.along(problem.experiment.predict(model))
    trials = [effect] if isinstance(effect, Expression) else list(effect.shape_grid(along))
    if not trials:
        raise EffectError(f"{effect.label} cannot be seen in these logs: its joint hardly moves")
    if isinstance(effect, Unknown) or not effect.shape:
        trials = trials[:1]
    best = min((_fitted(whitened.regression, base, e) for e in trials), key=lambda f: f[1])[0]
    contained = contained_terms(whitened.regression, best, effect.label)
    for term in contained:
        base, best = base.remove(term.label), best.remove(term.label)
    if contained:
        best = fitted_together(whitened.regression, best)
    best = refine_shapes(whitened.regression, best, [t.label for t in base.terms])
    whitened = problem.with_noise_of(problem.lack_of_fit(best))
    return concluded(whitened, base, best, report, forced=(effect.label,))


def _fitted(regression: Regression, base: Dynamics, effect: Effect) -> tuple[Dynamics, float]:
    """Return the base with an effect, fitted together, and the residual sum of squares [1]."""
    trial, equations = refit(regression, base.add(Term(effect, (0.0,) * effect.size)))
    return trial, bounded_fit(equations, range(len(trial.terms)), bodies=True).chi2
