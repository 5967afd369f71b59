"""The two sides of a question: effects that the arm may have, how large they may be, and in which shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.excitation.information import Information, torque_rms
from cdia_pin.regression.experiment import Experiment, rms

Array = NDArray[np.float64]

# Shapes of an effect [1] that are compared, spread over its grid, because each pair is fitted.
MOST_SHAPES = 6


@dataclass(frozen=True, eq=False)
class Side:
    """One explanation: an effect, or several together.

    Attributes:
        effects: The effects as they were asked for.
        shapes: The same in each shape that they may have.
        covariance: Second moments of their parameters in each shape, shape (p, p).
        precision: Of what is known of their parameters beforehand [1/unit²], shape (p,).
    """

    effects: tuple[Effect, ...]
    shapes: tuple[tuple[Effect, ...], ...]
    covariance: tuple[Array, ...]
    precision: Array

    @property
    def label(self) -> str:
        """The effects' labels, with + between them."""
        return " + ".join(e.label for e in self.effects)

    @property
    def all_effects(self) -> tuple[Effect, ...]:
        """Every effect in every shape."""
        return tuple(dict.fromkeys(e for shape in self.shapes for e in shape))


def side_of(effects: Sequence[Effect], model: Dynamics, reference: Experiment, share: float) -> Side:
    """Say how large and in which shapes effects may be.

    Args:
        effects: One effect, or several together.
        model: Effects that it has are taken with its numbers; others as large as said by `share`.
        reference: Motions on which sizes are measured.
        share: RMS torque of the effects, over that of the joint on which it is largest [1].
    """
    terms = {t.label: t for t in model.terms}
    known = [terms.get(e.label) for e in effects]
    x = reference.along(reference.predict(model))
    grids = [
        [term.effect] if term else _spread(list(e.shape_grid(x)) or [e])
        for e, term in zip(effects, known, strict=True)
    ]
    shapes = tuple(product(*grids))
    scales = np.concatenate([e.prior_scale(reference.robot) for e in effects])
    if all(term is not None for term in known):
        theta = np.concatenate([term.theta for term in known if term is not None])
        covariance = tuple(np.outer(theta, theta) for _ in shapes)
    else:
        covariance = tuple(_usual_size(shape, model, reference, share) for shape in shapes)
    return Side(tuple(effects), shapes, covariance, 1.0 / scales**2)


def _spread(shapes: list[Effect]) -> list[Effect]:
    """Return a few of many shapes, the first and the last among them; the slow ones closer together."""
    if len(shapes) <= MOST_SHAPES:
        return shapes
    at = np.unique(np.round(np.geomspace(1, len(shapes), MOST_SHAPES)).astype(int)) - 1
    return [shapes[i] for i in at]


def _usual_size(shape: tuple[Effect, ...], model: Dynamics, reference: Experiment, share: float) -> Array:
    """Return second moments of parameters by which effects have a share of the torque of a joint, shape (p, p)."""
    prediction = reference.predict(model)
    joint_torque = torque_rms(reference, model)
    spread, load = [], np.zeros(reference.robot.n)
    for effect in shape:
        x = reference.columns(effect, prediction)
        joints = list(effect.acts_on(reference.robot))
        size = np.array(
            [rms(x[:, :, k], reference.informative[:, joints]) for k in range(effect.size)]
        )  # (p, m)
        relative = size / joint_torque[joints]
        usual = effect.prior_scale(reference.robot)
        with np.errstate(divide="ignore"):
            alone = np.where(relative.max(axis=1) > 0, 1.0 / relative.max(axis=1), 0.0)
        each = np.where(np.isfinite(usual), usual, alone)
        spread.append(each)
        load[joints] += np.sum((each[:, None] * relative) ** 2, axis=0)
    most = float(np.sqrt(load.max()))
    scale = share / most if most > 0 else 0.0
    return np.diag((scale * np.concatenate(spread)) ** 2)


def separation(info: Information, hidden: Side, other: Side, rest: Sequence[Effect], known: Array) -> float:
    """Return the sum of squares by which the wrong explanation fits worse [1], in its best shape.

    It is the noncentrality of the test between the two: its root is their distance in standard deviations.

    Args:
        info: What the motion tells.
        hidden: What the arm has.
        other: What is fitted in its place.
        rest: Other effects, which are fitted along.
        known: Precision of the rest's parameters, shape (p,).
    """
    out = []
    for shape, covariance in zip(hidden.shapes, hidden.covariance, strict=True):
        for wrong in other.shapes:
            left = info.unexplained(shape, [*wrong, *rest], np.concatenate([other.precision, known]))
            out.append(float(np.sum(left * covariance)))
    return max(min(out), 0.0)
