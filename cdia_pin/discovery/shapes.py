"""Shapes: the grid finds the ripple or the Stribeck speed roughly, this finds it well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.discovery.candidates import Columns
from cdia_pin.discovery.experiment import Experiment
from cdia_pin.discovery.fitting import Whitened, gather
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term

SPREAD = 0.12  # first steps to either side, as a share of the shape
NARROWER = 0.4  # each round's steps beside those of the round before
ROUNDS = 4


def refine_shapes(experiment: Experiment, columns: Columns, model: Dynamics, whitened: Whitened) -> Dynamics:
    """Return the model with the shape of its terms moved to where the others allow the best fit.

    Args:
        experiment: The conditioned logs.
        columns: Where columns come from.
        model: A fitted model.
        whitened: Noise and blocks.
    """
    for term in [t for t in model.terms if t.effect.shape]:
        (name,) = term.effect.shape_values
        rest = [t.effect for t in model.terms if t.label != term.label]
        x = experiment.along(experiment.predict(model))
        grid = [e.shape_values[name] for e in term.effect.shape_grid(x)]
        spread = _first_spread(term.effect.shape_values[name], grid)
        best = term
        for _ in range(ROUNDS):
            value = best.effect.shape_values[name]
            tries = [best.effect.with_shape(**{name: value + d * spread}) for d in (-1.0, -0.5, 0.0, 0.5, 1.0)]
            tries = [e for e in tries if min(grid, default=value) <= e.shape_values[name] <= max(grid, default=value)] or [best.effect]
            prediction = experiment.predict(model.remove(term.label).add(best))
            evidence = gather(experiment, columns, prediction, [*rest, *tries], whitened)
            fits = [evidence.fit([*range(len(rest)), len(rest) + i]) for i in range(len(tries))]
            least = int(np.argmin([f.chi2 for f in fits]))
            best = replace(best, effect=tries[least], theta=_last(fits[least].theta, best))
            spread *= NARROWER
        model = Dynamics(model.robot, tuple(best if t.label == term.label else t for t in model.terms))
    return model


def _first_spread(value: float, grid: list[float]) -> float:
    """Return about the distance to the neighbours on the grid, so that the first round spans a cell."""
    if len(grid) < 2:
        return SPREAD * value
    distances = np.sort(np.abs(np.array(grid) - value))
    return float(max(distances[1] if len(distances) > 1 else distances[0], 1e-3 * value))


def _last(theta: np.ndarray, term: Term) -> tuple[float, ...]:
    return tuple(float(v) for v in theta[-term.effect.size :])
