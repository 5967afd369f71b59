"""The sizes of changes: differences with intervals, what was there before, and torques."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.difference import Difference
from cdia_pin.changes.evidence import Differing
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Effect, LinkInertia, Term, TorqueOffset, ViscousFriction
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.whitening import Whitening
from cdia_pin.selection.evidence import Evidence

Array = NDArray[np.float64]

PLAIN = (CoulombFriction, ViscousFriction, TorqueOffset)  # what nearly every joint has, besides rigid bodies


def sized(evidence: Evidence, chosen: tuple[int, ...]) -> list[Term]:
    """Return the differences of some effects, fitted together, with 95 % intervals.

    Args:
        evidence: Evidence for all changes.
        chosen: Indices of the changes; the terms come in this order.
    """
    alone = evidence.equations.restricted(chosen)
    theta = bounded_fit(alone, range(len(chosen))).theta
    terms = []
    for difference, part in zip(alone.effects, alone.parameters.split(theta), strict=True):
        assert isinstance(difference, Difference)
        terms.append(Term(difference.effect, tuple(part)))
    return list(with_intervals(Dynamics(evidence.robot, tuple(terms)), alone).terms)


def torque_of(differing: Differing, difference: Difference, term: Term) -> Array:
    """Return the RMS torque of a change in the logs after.

    Args:
        differing: The logs, and columns of all changes.
        difference: The change.
        term: The effect with the differences of its parameters.

    Returns:
        In N·m or N, shape (n,).
    """
    x = differing.experiment
    f = np.zeros_like(x.measured)
    for j, columns in differing.changes[difference].items():
        f[:, j] = columns @ np.array(term.theta)
    return rms(f, x.informative & differing.after[:, None])


def friction_before(
    differing: Differing, changed: Sequence[Difference], whitening: Whitening
) -> dict[Difference, tuple[float, ...]]:
    """Return the parameters of each changed friction before the change.

    The common structure consists here of rigid bodies, Coulomb and viscous friction and an offset, so that friction has
    its usual meaning. Smooth functions of speed would take a part of it.

    Args:
        differing: The logs, and columns of all changes.
        changed: The changes that were found.
        whitening: Noise that they leave.

    Returns:
        Parameters by change, shape (p,) each.
    """
    x, robot = differing.experiment, differing.experiment.robot
    asked = [d for d in changed if d.effect.traits.dissipative]
    if not asked:
        return {}
    described = {j for d in asked if d.size > 1 for j in d.scope}
    plain = [kind(j) for j in robot.joints for kind in PLAIN if kind is TorqueOffset or j not in described]
    known = [t.effect for t in differing.prediction.model.terms]
    bodies = [LinkInertia(j) for j in robot.joints]
    effects: list[Effect] = list(
        dict.fromkeys([*(d.effect for d in asked), *known, *bodies, *plain, *changed])
    )
    together = Regression(DesignMatrix(x), whitening).normal_equations(differing.prediction, effects)
    theta, _ = together.optimum(range(len(effects)))
    return {d: tuple(float(v) for v in theta[together.parameters[i]]) for i, d in enumerate(asked)}
