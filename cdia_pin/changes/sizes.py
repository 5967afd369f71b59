"""The sizes of changes: differences with intervals, what was there before, and torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import PLAIN
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.found_changes import FoundChanges
from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.effects import Effect, LinkInertia, Term, TorqueOffset
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.effort_scale import effort_tolerance
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression

Array = NDArray[np.float64]

# Where a joint moves one way, an offset cancels any friction: of a Kinova Gen3 490 N·m of each came out, where the
# joint needs 23. A load that helps the motion may make a torque half as large as the friction.
MOST_FRICTION = 2.0  # [1], RMS friction over the joint's RMS torque, above which it is not known


def sized(found: FoundChanges) -> list[Term]:
    """Return the differences of some effects, fitted together, with 95 % intervals.

    The statistical part comes from blocks of time, the systematic one from the tolerance of the torque's scale.

    Args:
        found: The changes; the terms come in their order.
    """
    search, chosen = found.search, found.chosen
    if not chosen:
        return []
    from scipy.special import stdtrit

    evidence, experiment = search.evidence, search.differing.experiment
    effects = [evidence.effects[c] for c in chosen]
    half = stdtrit(len(evidence.unseen) - 1, 0.975) * np.sqrt(np.diag(found.covariance))
    blocks = ParameterBlocks.of(effects)
    pairs = zip(effects, blocks.split(found.theta), blocks.split(half), strict=True)
    out = []
    for c, (e, value, statistical) in zip(chosen, pairs, strict=True):
        tolerance = effort_tolerance(experiment, e.effect, search.torque(c, value))
        total = np.hypot(statistical, tolerance * np.abs(value))
        out.append(Term(e.effect, tuple(value)).with_intervals(total, statistical if tolerance else None))
    return out


def covering(term: Term, other: Term) -> Term:
    """Return a change whose total intervals also cover another estimate of it.

    Args:
        term: The change, with intervals.
        other: The same change as it comes out otherwise, with intervals.
    """
    assert term.ci95 is not None
    assert other.ci95 is not None
    ends = np.concatenate([np.array(term.ci95), np.array(other.ci95)], axis=1)
    return replace(
        term.with_intervals(np.abs(ends - np.array(term.theta)[:, None]).max(axis=1)),
        ci95_statistical=term.ci95_statistical,
    )


def friction_before(
    differing: Differing, changed: Sequence[Difference]
) -> dict[Difference, tuple[float, ...]]:
    """Return the parameters of each changed friction before the change.

    The common structure consists here of rigid bodies, Coulomb and viscous friction and an offset, so that friction has
    its usual meaning. Other effects of the speed would take a part of it, and so would friction that the model has.

    Args:
        differing: The logs, and columns of all changes.
        changed: The changes that were found.

    Returns:
        Parameters by change, shape (p,) each, of the changes whose friction before is known.
    """
    robot, prediction = differing.experiment.robot, differing.prediction
    asked = [d for d in changed if d.effect.traits.dissipative]
    if not asked:
        return {}
    described = {j for d in asked if d.size > 1 for j in d.scope}
    plain = [kind(j) for j in robot.joints for kind in PLAIN if kind is TorqueOffset or j not in described]
    bodies = [LinkInertia(j) for j in robot.joints]
    effects: list[Effect] = list(dict.fromkeys([*(d.effect for d in asked), *bodies, *plain]))
    columns = DesignMatrix(differing.experiment)
    groups = [ColumnGroup.of(e, columns.of(e, prediction), robot, e.prior_scale(robot)) for e in effects]
    groups += [differing.changes[d] for d in changed]
    joints = {j for d in asked for j in d.scope}
    model = differing.given.model
    bare = [t for t in model.terms if not (is_friction_of_joint(t.effect) and joints & set(t.effect.scope))]
    left = differing.experiment.predict(replace(model, terms=tuple(bare))).residual
    theta = SharedRegression.of(groups, left, differing.scaled).theta()
    parts = dict(
        zip([*effects, *changed], ParameterBlocks.of([*effects, *changed]).split(theta), strict=True)
    )
    before = {d: parts[d.effect] - (parts[d] if d.sign < 0 else 0.0) for d in asked}
    by_effect = dict(zip(effects, groups, strict=False))

    def is_known(d: Difference) -> bool:
        torque = rms(by_effect[d.effect].torque(before[d], robot.n), differing.used)
        return bool((torque <= MOST_FRICTION * differing.torque).all())

    return {d: tuple(map(float, theta)) for d, theta in before.items() if is_known(d)}
