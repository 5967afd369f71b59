"""Terms that repeat each other: in some logs, the torque of one is a combination of the torques of others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.errors import EffectError
from cdia_pin.phrases import some
from cdia_pin.regression.normal_equations import REPEATED, NormalEquations
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.scaled_gram import ScaledGram

RIDGE = 1e-9  # added to a unit diagonal [1], because the others may repeat each other


def contained_terms(regression: Regression, model: Dynamics, label: str) -> tuple[Term, ...]:
    """Return the terms of a model whose torque is part of that of one term and of what is left of the others.

    Args:
        regression: The conditioned logs and their noise.
        model: A model that has the term.
        label: Label of the term.

    Raises:
        EffectError: If the torque of the term itself is a combination of those of the others.
    """
    equations = regression.normal_equations(model, [t.effect for t in model.terms])
    one = next(k for k, t in enumerate(model.terms) if t.label == label)
    rest = [k for k in range(len(model.terms)) if k != one]
    if _is_repeated(equations, one, rest):
        needed = [k for k in rest if not _is_repeated(equations, one, [r for r in rest if r != k])]
        has = some([model.terms[k].label for k in needed or rest], 3)
        raise EffectError(
            f"{label} adds nothing to {has}, which the model has: in these logs its torque is the same; "
            "give a model without that to fit it instead, or compare the logs with those that the model is of "
            "(cdia compare, cdia discover --model)"
        )
    contained: list[int] = []
    for k in rest:
        if _is_repeated(equations, k, [one, *(r for r in rest if r != k and r not in contained)]):
            contained.append(k)
    return tuple(model.terms[k] for k in contained)


def _is_repeated(equations: NormalEquations, one: int, others: Sequence[int]) -> bool:
    """Return True if other effects leave next to nothing of each column of an effect."""
    own, by = equations.columns([one]), equations.columns(others)
    gram = equations.total
    before = np.diag(gram)[own]
    if not len(by) or not before.any():
        return False
    mixed = gram[np.ix_(by, own)]
    left = before - np.einsum("bo,bo->o", mixed, ScaledGram.of(gram[np.ix_(by, by)], RIDGE).solve(mixed))
    return bool((left <= REPEATED * before).all())
