"""Shapes: the grid finds a ripple's frequency or a Stribeck speed roughly, parabolas find it nearly.

Then shapes and all parameters are fitted together.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ALWAYS, Term
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.gauss_newton import DIVERGED, fitted_together, has_converged, with_parameters
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.shape_slopes import Slope, slopes

ROUNDS = 7  # parabolas [1] through three shapes; the last step is about a thousandth of the first
SWEEPS = (
    3  # times [1] that several shapes of one effect are refined by turns, because each depends on the others
)
NARROWER = 0.35  # step of a round over that of the round before [1]
FARTHEST = 1.5  # largest move of one round over its step [1], because a parabola is only local
STEPS = 10  # steps [1] of shapes and parameters together; a guard, because most converge in two or three


def refine_shapes(regression: Regression, model: Dynamics, known: Collection[str] = ()) -> Dynamics:
    """Return the model with the shapes of its terms moved to the best fit, one after another and then together.

    Args:
        regression: The conditioned logs and their noise.
        model: A fitted model.
        known: Labels of terms whose shape stays as it is.
    """
    shaped = [t for t in model.terms if t.effect.shape and t.label not in known]
    for term in shaped:
        if term.profile != ALWAYS:  # a try is no term of the model, and would have no profile
            continue
        names = list(term.effect.shape_values)
        for name in names * (SWEEPS if len(names) > 1 else 1):
            model = _refined(regression, model, term.label, name)
    return with_shapes_fitted(regression, model, [t.label for t in shaped])


def with_shapes_fitted(regression: Regression, model: Dynamics, labels: Collection[str]) -> Dynamics:
    """Return the model with shapes and the parameters of all terms fitted together by the Gauss-Newton method.

    A step that leaves more than there was before it was too long for the linearisation, and is halved.

    Args:
        regression: The conditioned logs and their noise.
        model: A model whose shapes are near the best fit.
        labels: Labels of the terms whose shapes move; without any, the model stays as it is.
    """
    if not labels:
        return model
    limits = {
        (t.label, name): _limits(_grid(regression, model, t, name), value)
        for t in model.terms
        if t.label in labels
        for name, value in t.effect.shape_values.items()
    }
    best, least = model, np.inf
    with suppress(*DIVERGED):
        model = fitted_together(regression, model, 1)
        for _ in range(STEPS):
            moving = list(_moving(model, limits))
            equations = regression.normal_equations(model, [*(t.effect for t in model.terms), *moving])
            theta = np.append(model.theta, np.zeros(len(moving)))
            every = range(len(equations.effects))
            left = equations.objective(every, theta)
            if left >= least:
                model = _halfway(best, model)
                continue
            best, least = model, left
            fit = bounded_fit(equations, every, bodies=True)
            if has_converged(left - fit.objective, fit, equations):
                break
            model = with_parameters(model, fit.theta[: len(theta) - len(moving)])
            for slope, step in zip(moving, fit.theta[len(theta) - len(moving) :], strict=True):
                value = slope.effect.shape_values[slope.of_shape] + float(step)
                model = _with_shape(model, slope.effect.label, **{slope.of_shape: value})
    return best


def _moving(model: Dynamics, limits: Mapping[tuple[str, str], tuple[float, float]]) -> Iterator[Slope]:
    """Yield the slopes of the shapes that have limits, each with the steps that stay within them."""
    for slope in slopes(model):
        at = (slope.effect.label, slope.of_shape)
        if at in limits:
            here, (low, high) = slope.effect.shape_values[slope.of_shape], limits[at]
            yield replace(slope, limits=(min(low - here, 0.0), max(high - here, 0.0)))


def _with_shape(model: Dynamics, label: str, **shape: float) -> Dynamics:
    """Return the model with other shapes of one term."""
    return Dynamics(
        model.robot,
        tuple(
            replace(t, effect=t.effect.with_shape(**shape)) if t.label == label else t for t in model.terms
        ),
    )


def _halfway(one: Dynamics, two: Dynamics) -> Dynamics:
    """Return the model halfway between two models of the same terms."""
    pairs = list(zip(one.terms, two.terms, strict=True))
    model = with_parameters(two, np.concatenate([np.add(a.theta, b.theta) / 2 for a, b in pairs]))
    for a, b in pairs:
        before, after = a.effect.shape_values, b.effect.shape_values
        if before != after:
            model = _with_shape(model, b.label, **{k: (before[k] + after[k]) / 2 for k in before})
    return model


def _limits(grid: Sequence[float], here: float) -> tuple[float, float]:
    """Return the least and the largest value of a grid, or the present value where the grid is empty."""
    return min(grid, default=here), max(grid, default=here)


def _grid(regression: Regression, model: Dynamics, term: Term, name: str) -> list[float]:
    """Return the values of a shape that the motion can show, in its unit."""
    experiment = regression.experiment
    return [e.shape_values[name] for e in term.effect.shape_grid(experiment.along(experiment.predict(model)))]


def _refined(regression: Regression, model: Dynamics, label: str, name: str) -> Dynamics:
    """Return the model with one shape parameter of one term moved to the best fit."""
    term = model.find(label)
    rest = [t.effect for t in model.terms if t.label != label]
    grid = _grid(regression, model, term, name)
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
        moved = float(np.clip(value + step, *_limits(grid, value)))
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
