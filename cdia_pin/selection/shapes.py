"""Shapes: the grid finds a ripple's frequency or a Stribeck speed roughly; parabolas refine it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.regression import Regression

ROUNDS = 7  # parabolas [1] through three shapes; the last step is about a thousandth of the first
SWEEPS = (
    3  # times [1] that several shapes of one effect are refined by turns, because each depends on the others
)
NARROWER = 0.35  # step of a round over that of the round before [1]
FARTHEST = 1.5  # largest move of one round over its step [1], because a parabola is only local


def refine_shapes(regression: Regression, model: Dynamics, known: Collection[str] = ()) -> Dynamics:
    """Return the model with the shapes of its terms moved to the best fit, one shape after another.

    Args:
        regression: The conditioned logs and their noise.
        model: A fitted model.
        known: Labels of terms whose shape stays as it is.
    """
    for term in [t for t in model.terms if t.effect.shape and t.label not in known]:
        names = list(term.effect.shape_values)
        for name in names * (SWEEPS if len(names) > 1 else 1):
            model = _refined(regression, model, term.label, name)
    return model


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
