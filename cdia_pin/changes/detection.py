"""What changed on an arm between two logs or two groups of logs. Their motions may differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.changes_result import Bound, Change, Changes
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.evidence import Differing
from cdia_pin.changes.interpretation import findings_of
from cdia_pin.changes.sizes import friction_before, sized, torque_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.errors import LogError
from cdia_pin.identifiability.alternatives import Alternatives
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import motion_between
from cdia_pin.logs.conditioning import Motion, condition
from cdia_pin.logs.log import Log
from cdia_pin.progress import Progress, silent
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.whitening import Whitening
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.evidence import Evidence
from cdia_pin.selection.moves import improve, names
from cdia_pin.version import __version__

Array = NDArray[np.float64]

PASSES = (
    4  # searches at most [1], each with the noise that the one before left; it ends sooner if nothing changes
)
MOST_MOVES = 60  # moves of one search [1]; a guard, because no set is visited twice
MEDIAN = 0.6745  # median of the absolute value of a normal variable, in standard deviations [1]


def what_changed(
    model: Dynamics,
    before: Log | Sequence[Log],
    after: Log | Sequence[Log],
    *,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
) -> Changes:
    """Find the effects by which an arm differs between logs.

    Args:
        model: The model of the arm as it is known. It may be wrong if it is wrong in the same way before and after.
        before: One log or several.
        after: One log or several; their motions may be different.
        settings: What may have changed, and how logs are conditioned.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The changes, and the largest changes that would not be found.

    Raises:
        LogError: If a log is too short, of other joints, or on both sides.
        EffectError: If the settings name an unknown effect.
    """
    tell = progress or silent
    settings = settings or DiscoverySettings()
    first, last = ([side] if isinstance(side, Log) else list(side) for side in (before, after))
    if not first or not last:
        raise LogError("what_changed needs at least one log before and one after")
    tell("conditioning", 0.0)
    motions = [condition(log, model.robot, settings.conditioning) for log in (*first, *last)]
    experiment = Experiment.of(model.robot, motions, settings.rest)
    sides = [
        tuple(s.state.log for s in part)
        for part in (experiment.segments[: len(first)], experiment.segments[len(first) :])
    ]
    if set(sides[0]) & set(sides[1]):
        raise LogError(
            f"logs before and after must be of different conditions, both have {', '.join(sides[0])}"
        )
    tell("fitting what the logs have in common", 0.1)
    noise = _noise([*first, *last], motions)
    differing = Differing.of(experiment, experiment.predict(model), len(first), noise, settings)
    found, whitened = _search(differing, settings, tell)
    tell("computing intervals", 0.9)
    evidence = differing.evidence(whitened, found)
    chosen = _indices(evidence, found)
    earlier = friction_before(differing, found, whitened)
    changes = tuple(
        _change(differing, evidence, chosen, one, earlier) for one in _by_evidence(evidence, chosen)
    )
    errors = [
        rms(differing.prediction.residual, experiment.informative & of[:, None])
        for of in (~differing.after, differing.after)
    ]
    tell("done", 1.0)
    return Changes(
        model=model,
        before=sides[0],
        after=sides[1],
        changes=changes,
        bounds=_bounds(differing, evidence, chosen),
        findings=findings_of(changes, model.robot),
        rms_before=errors[0],
        rms_after=errors[1],
        record={
            "version": __version__,
            "before": [m.record for m in motions[: len(first)]],
            "after": [m.record for m in motions[len(first) :]],
            "blocks": settings.blocks,
            "effects": list(settings.effects) if settings.effects else "all",
        },
    )


def _search(
    differing: Differing, settings: DiscoverySettings, tell: Progress
) -> tuple[tuple[Difference, ...], Whitening]:
    """Return the set of changes that no move improves, and the noise that it leaves."""
    whitened = differing.whitened(differing.generic())
    found: tuple[Difference, ...] = ()
    for k in range(PASSES):
        tell("looking for changes", 0.3 + 0.6 * k / PASSES)
        evidence = differing.evidence(whitened, found)
        chosen = _improved(evidence, _indices(evidence, found), settings.most_effects)
        last, found = found, tuple(evidence.effects[c] for c in chosen)  # type: ignore[misc]
        whitened = differing.whitened(found)
        if k > 0 and set(found) == set(last):
            break
    return found, whitened


def _improved(evidence: Evidence, now: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Return the set of changes that no move improves."""
    visited = {names(evidence, now)}
    for _ in range(MOST_MOVES):
        better = improve(evidence, now, lambda c: names(evidence, c) not in visited, most=most)
        if better is None:
            break
        now = better.chosen
        visited.add(names(evidence, now))
    return now


def _indices(evidence: Evidence, found: Sequence[Difference]) -> tuple[int, ...]:
    return tuple(i for i, e in enumerate(evidence.effects) if e in found)


def _by_evidence(evidence: Evidence, chosen: tuple[int, ...]) -> list[int]:
    """Return the changes in the order of what would be lost without them."""
    return sorted(chosen, key=lambda c: -_missed(evidence, chosen, c))


def _missed(evidence: Evidence, chosen: tuple[int, ...], one: int) -> float:
    """Return by how much the residual sum of squares would grow without one change [1]."""
    rest = [c for c in chosen if c != one]
    return evidence.free_chi2(rest) - evidence.free_chi2(chosen)


def _change(
    differing: Differing,
    evidence: Evidence,
    chosen: tuple[int, ...],
    one: int,
    earlier: Mapping[Difference, tuple[float, ...]],
) -> Change:
    difference = evidence.effects[one]
    assert isinstance(difference, Difference)
    term = sized(evidence, chosen)[chosen.index(one)]
    return Change(
        term,
        earlier.get(difference),
        torque_of(differing, difference, term),
        _missed(evidence, chosen, one) / 2,
        tuple(_plain(c, term, evidence.robot) for c in Alternatives(evidence, chosen).of(one)),
    )


def _plain(confusion: Confusion, term: Term, robot: RobotModel) -> Confusion:
    """Return a confusion between the effects themselves instead of their differences."""
    others = tuple(e.effect if isinstance(e, Difference) else e for e in confusion.effects)
    return replace(confusion, effects=others, motion=motion_between(term.effect, others[0], robot))


def _bounds(differing: Differing, evidence: Evidence, chosen: tuple[int, ...]) -> dict[str, Bound]:
    """Return for each joint the largest change of one parameter that would not be found."""
    robot = evidence.robot
    out: dict[str, Bound] = {}
    for c, difference in enumerate(evidence.effects):
        joints = difference.acts_on(robot)
        if c in chosen or difference.size > 1 or difference.shape or len(joints) > 1:
            continue
        assert isinstance(difference, Difference)
        term = sized(evidence, (*chosen, c))[-1]
        assert term.ci95 is not None
        furthest = max(term.ci95[0], key=abs)
        limit = replace(term, theta=(furthest,), ci95=None)
        bound = Bound(limit, float(torque_of(differing, difference, limit)[joints[0]]))
        joint = robot.joints[joints[0]]
        if joint not in out or bound.torque > out[joint].torque:
            out[joint] = bound
    return {j: out[j] for j in robot.joints if j in out}


def _noise(logs: Sequence[Log], motions: Sequence[Motion]) -> Array:
    """Return the noise of the compared torques that is rough from sample to sample [N·m or N], shape (n,).

    Second differences do not contain the motion, and their median does not contain steps. A residual beyond this noise
    comes from a wrong model, which may be wrong in another way on another motion.
    """
    parts = []
    for log, motion in zip(logs, motions, strict=True):
        rough = np.median(np.abs(np.diff(log.effort, 2, axis=0)), axis=0) / MEDIAN / np.sqrt(6.0)
        parts.append(rough**2 * min(2 * motion.cutoff / log.rate, 1.0))
    return np.asarray(np.sqrt(np.maximum(np.mean(parts, axis=0), 1e-24)))
