"""Shapes: the grid finds the ripple or the Stribeck speed roughly, this finds it well."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.regression.design_matrix import Columns
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.fitting import Whitened, gather

ROUNDS = 7
NARROWER = 0.35  # each round's steps beside those of the round before


def refine_shapes(
    experiment: Experiment, columns: Columns, model: Dynamics, whitened: Whitened, known: Collection[str] = ()
) -> Dynamics:
    """Return the model with the shape of its terms moved to where the others allow the best fit.

    Args:
        experiment: The conditioned logs.
        columns: Where columns come from.
        model: A fitted model.
        whitened: Noise and blocks.
        known: Labels of terms whose shape is left as it is.
    """
    for term in [t for t in model.terms if t.effect.shape and t.label not in known]:
        (name,) = term.effect.shape_values
        rest = [t.effect for t in model.terms if t.label != term.label]
        grid = [
            e.shape_values[name] for e in term.effect.shape_grid(experiment.along(experiment.predict(model)))
        ]
        start = term.effect.shape_values[name]
        best, spread = term, min(_cell(start, grid), start) / 2
        for _ in range(ROUNDS):
            value = best.effect.shape_values[name]
            tries = [best.effect.with_shape(**{name: value + d}) for d in (-spread, 0.0, spread)]
            prediction = experiment.predict(model.remove(term.label).add(best))
            evidence = gather(experiment, columns, prediction, [*rest, *tries], whitened)
            fits = [evidence.fit([*range(len(rest)), len(rest) + i]) for i in range(len(tries))]
            step = float(np.clip(_bottom(*(f.chi2 for f in fits)), -1.5, 1.5)) * spread
            moved = float(np.clip(value + step, min(grid, default=value), max(grid, default=value)))
            best = replace(
                best, effect=best.effect.with_shape(**{name: moved}), theta=_last(fits[1].theta, best)
            )
            spread *= NARROWER
        model = Dynamics(model.robot, tuple(best if t.label == term.label else t for t in model.terms))
    return model


def _cell(value: float, grid: list[float]) -> float:
    """Return the distance to the nearest other shape of the grid."""
    others = [abs(g - value) for g in grid if abs(g - value) > 1e-6 * abs(value)]
    return min(others, default=0.1 * abs(value))


def _bottom(left: float, middle: float, right: float) -> float:
    """Return where the parabola through three neighbouring values is least, in steps from the middle."""
    curve = left - 2 * middle + right
    if curve <= 1e-9 * (abs(left) + abs(right)):
        return -1.0 if left < right else 1.0
    return 0.5 * (left - right) / curve


def _last(theta: np.ndarray, term: Term) -> tuple[float, ...]:
    return tuple(float(v) for v in theta[-term.effect.size :])
