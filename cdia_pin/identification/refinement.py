"""Richer friction laws, where they predict held-out blocks of time better."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Expression
from cdia_pin.identification.block_validation import block_errors, is_better, of_effects
from cdia_pin.identification.estimate import Estimate, Fitter, unconstrained
from cdia_pin.identification.prior import precision
from cdia_pin.identification.terms import Refinement, refinements
from cdia_pin.progress import Progress
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.regression import Regression
from cdia_pin.selection.idle_drives import has_idle_drive, without_idle_drives

Array = NDArray[np.float64]

ROUNDS = 6  # rounds [1], each of at most one law per joint; a guard, because each law must explain enough


def refine(fitter: Fitter, estimate: Estimate, tell: Progress, keep: Callable[[Dynamics], None]) -> Estimate:
    """Add to each joint the law that lowers its held-out error most, until no law does.

    Args:
        fitter: Fitter of the experiment.
        estimate: Estimate of the model with the plain laws.
        tell: Called with what was added and the share done [1].
        keep: Called with each better model.
    """
    tried: set[str] = set()
    for k in range(ROUNDS):
        chosen = _best_of_each_joint(fitter, estimate, tried)
        if not chosen:
            break
        model = estimate.model
        for law in chosen:
            model = law.of(model)
        tell(", ".join(f"+ {law.added.label}" for law in chosen), k / ROUNDS)
        tried.update(law.added.label for law in chosen)
        estimate = fitted_without_idle_drives(fitter, model, estimate.strength)
        keep(estimate.model)
    return estimate


def fitted_without_idle_drives(fitter: Fitter, model: Dynamics, strength: float) -> Estimate:
    """Fit a model, without the gains of drives that could then not have moved the arm.

    Args:
        fitter: Fitter of the experiment.
        model: The model; the iteration starts at the parameters of its terms.
        strength: Strength of the prior [1].
    """
    estimate = fitter.fit(model, strength)
    while has_idle_drive(estimate.model):
        estimate = fitter.fit(without_idle_drives(estimate.model), strength)
    return estimate


def _best_of_each_joint(fitter: Fitter, estimate: Estimate, tried: Container[str]) -> list[Refinement]:
    """Return the laws that lower the held-out errors most, none that was tried before."""
    experiment, whitening = fitter.experiment, estimate.whitening
    laws = [
        law
        for law in refinements(estimate.model, experiment, fitter.settings)
        if law.added.label not in tried
    ]
    present = [t.effect for t in estimate.model.terms]
    effects = [*present, *(law.added for law in laws)]
    equations = Regression(fitter.design, whitening).normal_equations(estimate.model, effects)
    prior = precision(equations, experiment, whitening, estimate.strength)
    base = range(len(present))
    before = _errors(equations, prior, list(base))
    least = _least_gain(fitter, estimate, float(before.sum()))
    best: dict[str, tuple[float, Refinement]] = {}
    for i, law in enumerate(laws, start=len(present)):
        chosen = [k for k in base if present[k].label not in law.replaced] + [i]
        after = _errors(equations, prior, chosen)
        gain = float(before.sum() - after.sum())
        joint = law.added.scope[0]
        if gain < least[joint] or gain <= best.get(joint, (0.0,))[0] or not is_better(after, before):
            continue
        if _is_physical(equations, prior, chosen, law):
            best[joint] = (gain, law)
    return [law for _, law in best.values()]


def _least_gain(fitter: Fitter, estimate: Estimate, total: float) -> dict[str, float]:
    """Return the sum of squares that a law of each joint must explain [1], by joint."""
    experiment, whitening = fitter.experiment, estimate.whitening
    sigma = np.array([float(np.mean(m.sigma)) for m in whitening.noise])
    count = whitening.used.sum(axis=0)
    visible = count * (fitter.settings.least_torque * rms(experiment.measured, whitening.used) / sigma) ** 2
    least = np.maximum(visible, fitter.settings.least_gain * total / experiment.robot.n)
    return dict(zip(experiment.robot.joints, least.tolist(), strict=True))


def _errors(equations: NormalEquations, prior: Array, chosen: Sequence[int]) -> Array:
    at = of_effects(equations, chosen)
    p = at[:-1]
    return block_errors(
        equations.total[np.ix_(at, at)], equations.blocks[:, at[:, None], at], prior[np.ix_(p, p)]
    )


def _is_physical(equations: NormalEquations, prior: Array, chosen: Sequence[int], law: Refinement) -> bool:
    """Return True if the best parameters of the law are those of friction."""
    at = of_effects(equations, chosen)
    p = at[:-1]
    theta = unconstrained(equations.total[np.ix_(at, at)], prior[np.ix_(p, p)])[-law.added.size :]
    if isinstance(law.added, Expression):
        return bool((theta >= 0).all())
    return law.added.is_physical(theta, equations.robot) and law.added.is_distinct(theta)
