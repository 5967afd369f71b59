"""The sizes of changes: differences with intervals, what was there before, and torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.evidence import Difference, Differing
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Effect, LinkInertia, Term, TorqueOffset, ViscousFriction
from cdia_pin.regression.design_matrix import Columns
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.fitting import Whitened, gather, with_intervals
from cdia_pin.selection.evidence import Evidence

Array = NDArray[np.float64]

PLAIN = (CoulombFriction, ViscousFriction, TorqueOffset)  # with rigid bodies, what nearly every joint has


def sized(evidence: Evidence, chosen: tuple[int, ...]) -> list[Term]:
    """Return the differences of some effects, fitted together, with 95 % intervals, in the order given."""
    columns = np.concatenate([evidence.spans[c] for c in chosen])
    at = np.append(columns, -1)
    alone = replace(
        evidence,
        effects=[evidence.effects[c] for c in chosen],
        blocks=evidence.blocks[:, at][:, :, at],
        needed=None,
    )
    theta, terms, start = alone.fit(range(len(chosen))).theta, [], 0
    for difference in alone.effects:
        assert isinstance(difference, Difference)
        terms.append(Term(difference.effect, tuple(theta[start : start + difference.size])))
        start += difference.size
    return list(with_intervals(Dynamics(evidence.robot, tuple(terms)), alone).terms)


def torque_of(differing: Differing, difference: Difference, term: Term) -> Array:
    """Return the RMS torque of a change in the logs after [N·m or N], shape (n,)."""
    x = differing.experiment
    f = np.zeros_like(x.measured)
    for j, columns in differing.changes[difference].items():
        f[:, j] = columns @ np.array(term.theta)
    return rms(f, x.informative & differing.after[:, None])


def friction_before(
    differing: Differing, changed: Sequence[Difference], whitened: Whitened
) -> dict[Difference, tuple[float, ...]]:
    """Return the parameters of each changed friction as they were before.

    What is common is described here by rigid bodies, Coulomb and viscous friction and an offset, so that the friction
    has its usual meaning: smooth functions of speed would have taken a part of it.
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
    together = gather(x, Columns(x), differing.prediction, effects, whitened)
    theta = together.without(np.zeros_like(together.total), range(len(effects)))
    return {d: tuple(float(v) for v in theta[together.spans[i]]) for i, d in enumerate(asked)}
