"""Shapes: the grid finds a ripple's frequency or a Stribeck speed roughly; parabolas refine it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.gauss_newton import CONVERGED, fitted_together, with_parameters
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.shape_slopes import slopes

ROUNDS = 7  # parabolas [1] through three shapes; the last step is about a thousandth of the first
SWEEPS = (
    3  # times [1] that several shapes of one effect are refined by turns, because each depends on the others
)
NARROWER = 0.35  # step of a round over that of the round before [1]
STEPS = 10  # joint steps [1] of shapes and parameters; a guard, because most converge in two or three
FARTHEST = 1.5  # largest move of one round over its step [1], because a parabola is only local


def refine_shapes(regression: Regression, model: Dynamics, known: Collection[str] = ()) -> Dynamics:
    """Return the model with the shapes of its terms moved to the best fit, one after another and then together.

    Args:
        regression: The conditioned logs and their noise.
        model: A fitted model.
        known: Labels of terms whose shape stays as it is.
    """
    shaped = [t for t in model.terms if t.effect.shape and t.label not in known]
    for term in shaped:
        names = list(term.effect.shape_values)
        for name in names * (SWEEPS if len(names) > 1 else 1):
            model = _refined(regression, model, term.label, name)
    return with_shapes_fitted(regression, model, [t.label for t in shaped])


def with_shapes_fitted(regression: Regression, model: Dynamics, labels: Collection[str]) -> Dynamics:
    """Return the model with shapes and the parameters of all terms fitted together by the Gauss-Newton method.

    Args:
        regression: The conditioned logs and their noise.
        model: A model whose shapes are near the best fit.
        labels: Labels of the terms whose shapes move; without any, the model stays as it is.
    """
    if not labels:
        return model
    best, least = model, np.inf
    model = fitted_together(regression, model, 1)
    for _ in range(STEPS):
        effects = [t.effect for t in model.terms]
        moving = [s for s in slopes(model) if s.effect.label in labels]
        equations = regression.normal_equations(model, [*effects, *moving])
        theta = np.concatenate([*(t.theta for t in model.terms), np.zeros(len(moving))])
        every = range(len(effects) + len(moving))
        left = equations.chi2(equations.columns(every), theta)
        if left >= least:  # the step was too long for the linearisation
            break
        best, least = model, left
        fit = bounded_fit(equations, every, bodies=True)
        if left - fit.chi2 < CONVERGED**2 * max(1.0, fit.chi2 / max(equations.samples, 1)):
            break
        model = with_parameters(model, fit.theta[: len(theta) - len(moving)])
        for slope, step in zip(moving, fit.theta[len(theta) - len(moving) :], strict=True):
            model = _reshaped(model, slope.effect.label, slope.of_shape, step)
    return best


def _reshaped(model: Dynamics, label: str, name: str, step: float) -> Dynamics:
    """Return the model with one shape of one term moved by a step, within the bounds of the shape."""
    term = model.find(label)
    limits = next(p for p in term.effect.shape if p.name == name)
    value = float(np.clip(term.effect.shape_values[name] + step, limits.lower, limits.upper))
    moved = replace(term, effect=term.effect.with_shape(**{name: value}))
    return Dynamics(model.robot, tuple(moved if t is term else t for t in model.terms))


def _refined(regression: Regression, model: Dynamics, label: str, name: str) -> Dynamics:
    """Return the model with one shape parameter of one term moved to the best fit."""
    experiment = regression.experiment
    term = next(t for t in model.terms if t.label == label)
    rest = [t.effect for t in model.terms if t.label != label]
    grid = [e.shape_values[name] for e in term.effect.shape_grid(experiment.along(experiment.predict(model)))]
    start = term.effect.shape_values[name]
    bounds = next(p for p in term.effect.shape if p.name == name)
    joints, equations = term.effect.acts_on(model.robot), None
    cell = _cell(start, grid)
    best, spread = term, (min(cell, start) if bounds.lower > 0 else cell) / 2
    for _ in range(ROUNDS):
        value = best.effect.shape_values[name]
        room = min(spread, value - bounds.lower, bounds.upper - value)
        if room <= 0:
            break
        tries = [best.effect.with_shape(**{name: value + d}) for d in (-room, 0.0, room)]
        around = model.remove(label).add(best)
        equations = regression.normal_equations(around, [*rest, *tries], like=equations, but=joints)
        fits = [bounded_fit(equations, [*range(len(rest)), len(rest) + i]) for i in range(len(tries))]
        step = float(np.clip(_bottom(*(f.chi2 for f in fits)), -FARTHEST, FARTHEST)) * room
        moved = float(np.clip(value + step, min(grid, default=value), max(grid, default=value)))
        theta = tuple(float(v) for v in fits[1].theta[-best.effect.size :])
        best = replace(best, effect=best.effect.with_shape(**{name: moved}), theta=theta)
        spread *= NARROWER
    return Dynamics(model.robot, tuple(best if t.label == label else t for t in model.terms))


def _cell(value: float, grid: list[float]) -> float:
    """Return the distance to the nearest other shape of the grid."""
    others = [abs(g - value) for g in grid if abs(g - value) > 1e-6 * abs(value)]
    return min(others, default=0.1 * abs(value))


def _bottom(left: float, middle: float, right: float) -> float:
    """Return the minimum of the parabola through three neighbouring values, in steps from the middle [1]."""
    curve = left - 2 * middle + right
    if curve <= 1e-9 * (abs(left) + abs(right)):
        return -1.0 if left < right else 1.0
    return 0.5 * (left - right) / curve
