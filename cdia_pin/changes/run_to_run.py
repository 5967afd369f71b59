"""From run to run, friction and the scale of a torque differ a little although nothing happened to the arm.

Temperature, grease and the time at rest before a run are in no log. So a change of friction is named only if it is
larger than what an unchanged arm shows, and the interval of a gain allows for it. The other joints of the same two logs
say how much that is here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.phenomenon import Phenomenon, PhenomenonKind
from cdia_pin.effects import ActuatorGain, Effect, Term, TorqueOffset
from cdia_pin.effects.refinements import is_plain
from cdia_pin.phrases import some
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.intervals import NORMAL_95
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.selection.discovery_settings import RunToRunSettings

Array = NDArray[np.float64]

LEAST_CERTAINTY = 1e-9  # [1], so that none is divided by zero
LEAST_TORQUE = 1e-12  # [N·m or N], likewise
TEMPERATURE = (PhenomenonKind.WARMING, PhenomenonKind.COOLING)
MEDIAN_OF_NORMAL = 0.6745  # median of |x| over the standard deviation of a normal x [1]


class UsualFrictionJson(TypedDict):
    """A usual difference of friction in JSON."""

    joint: str
    effects: list[str]
    share: float
    limit: float


@dataclass(frozen=True)
class UsualFriction:
    """A difference of a joint's friction that is no larger than what an unchanged arm shows.

    Attributes:
        joint: Name of the joint.
        effects: Labels of the effects that differ.
        share: RMS torque of the difference over that of the friction that both sides have in common [1].
        limit: Share [1] above which it counts as a change.
    """

    joint: str
    effects: tuple[str, ...]
    share: float
    limit: float

    def to_dict(self) -> UsualFrictionJson:
        """Return the difference for JSON."""
        return {"joint": self.joint, "effects": [*self.effects], "share": self.share, "limit": self.limit}


@dataclass(frozen=True, repr=False)
class RunToRun:
    """Friction of two sides of logs, joint by joint.

    Attributes:
        joints: Names of the joints.
        friction: RMS torque of the friction that both sides have in common, along the logs after [N·m or N], shape
            (n,).
        growth: Share by which the friction differs, without what its uncertainty explains, negative where it fell; NaN
            where it is not known [1], shape (n,).
        scales: Share by which the torque differs, likewise [1], shape (n,).
        visible_gain: Gain from which on what it scales besides friction would be visible [1], shape (n,).
        settings: How much an unchanged arm shows.
        after: Share of the samples that count that are of the logs after [1], shape (n,).
    """

    joints: tuple[str, ...]
    friction: Array
    growth: Array
    scales: Array
    visible_gain: Array
    settings: RunToRunSettings
    after: Array

    def __repr__(self) -> str:
        return f"RunToRun({int(np.isfinite(self.growth).sum())} of {len(self.joints)} joints)"

    @classmethod
    def of(cls, search: ChangeSearch, chosen: Sequence[int]) -> Self:
        """Compare the friction of all joints beside the changes that are not of their friction.

        Args:
            search: The search for changes.
            chosen: Indices of what it found.
        """
        x = search.differing
        friction = _common_friction(x)
        others = np.maximum(rms(x.experiment.measured + friction, x.counted), LEAST_TORQUE)
        return cls(
            x.experiment.robot.joints,
            rms(friction, x.counted),
            _growth(search, chosen, friction),
            _scales(search, chosen),
            search.settings.least_torque * x.torque / others,
            x.settings.run_to_run,
            x.samples / np.maximum(x.counted.sum(axis=0) + x.counted_before.sum(axis=0), 1),
        )

    def spread(self, joint: int) -> float:
        """Return the standard deviation of the share by which a joint's friction differs though nothing happened [1].

        Args:
            joint: Index of the joint.
        """
        rule = self.settings
        return min(self._spread(self.growth, joint, rule.spread), rule.largest_spread)

    def _spread(self, differences: Array, joint: int, known: float) -> float:
        """Return a standard deviation that is known beforehand and that other joints show, together [1]."""
        weight, others = self.settings.weight, np.delete(differences, joint)
        others = others[np.isfinite(others)]
        seen = float(np.median(np.abs(others))) / MEDIAN_OF_NORMAL if len(others) else 0.0
        return float(np.sqrt((weight * known**2 + len(others) * seen**2) / (weight + len(others))))

    def limit(self, joint: int) -> float:
        """Return the share of its friction by which a joint may differ although nothing happened [1].

        Args:
            joint: Index of the joint.
        """
        return self.settings.deviations * self.spread(joint)

    def size(self, joint: int) -> float:
        """Return the RMS torque by which a joint's friction may differ although nothing happened [N·m or N].

        Args:
            joint: Index of the joint.
        """
        return self.limit(joint) * float(self.friction[joint])

    def allowed_for(self, term: Term, torque: Array) -> Term:
        """Return a change whose total intervals allow for how friction and scales of torques differ from run to run.

        A part of the difference would be there although nothing happened. Blocks of the same two runs do not show it.

        Args:
            term: A change with intervals; one that is neither of friction nor of a gain stays as it is.
            torque: Its RMS torque [N·m or N], shape (n,).
        """
        joints = [self.joints.index(j) for j in term.effect.scope]
        if isinstance(term.effect, ActuatorGain):
            spread = self._spread(self.scales, joints[0], self.settings.scale)
            return term.less_certain(NORMAL_95 * spread * np.abs(1.0 + np.array(term.theta)))
        if not term.effect.traits.dissipative or not joints:
            return term
        usual = np.array([self.spread(j) for j in joints]) * self.friction[joints]
        share = np.linalg.norm(usual) / max(float(np.linalg.norm(torque[joints])), LEAST_TORQUE)
        return term.less_certain(NORMAL_95 * share * np.abs(term.theta))

    def usual(
        self, search: ChangeSearch, chosen: Sequence[int], terms: Sequence[Term]
    ) -> list[UsualFriction]:
        """Return the joints whose friction differs, but no more than that of an unchanged arm.

        A gain of a joint that carries little scales friction, and nothing else that would be visible.

        Args:
            search: The search for changes.
            chosen: Indices of what it found.
            terms: Their sizes, in the same order.
        """
        x = search.differing
        torque = np.zeros_like(x.prediction.residual)  # what friction of any kind differs by
        labels: dict[int, list[str]] = {}
        for c, term in zip(chosen, terms, strict=True):
            if is_friction_of_joint(term.effect) or self._scales_friction(term):
                j = self.joints.index(term.effect.scope[0])
                group = x.changes[search.evidence.effects[c]]
                torque += group.torque(np.array(term.theta), len(self.joints))
                labels.setdefault(j, []).append(term.label)
        out = []
        size = np.hypot(rms(torque, x.counted), rms(torque, x.counted_before))  # where it is, or was
        for j, own in labels.items():
            share, limit = float(size[j]) / max(float(self.friction[j]), LEAST_TORQUE), self.limit(j)
            if share <= limit:
                out.append(UsualFriction(self.joints[j], tuple(own), share, limit))
        return out

    def _scales_friction(self, term: Term) -> bool:
        """Tell whether a change is a gain, and what it scales is friction as far as can be seen."""
        if not isinstance(term.effect, ActuatorGain):
            return False
        return abs(term.theta[0]) < float(self.visible_gain[self.joints.index(term.effect.joint)])


def _common_friction(x: Differing) -> Array:
    """Return the torque of all friction that both sides have, joint by joint [N·m or N], shape (K, n).

    Where a joint moves one way, an offset may cancel any friction. Where both together are less, they are the friction.
    """
    friction, offset = np.zeros_like(x.prediction.residual), np.zeros_like(x.prediction.residual)
    for term in x.prediction.model.terms:
        is_offset = isinstance(term.effect, TorqueOffset)
        if is_offset or is_friction_of_joint(term.effect):
            columns = x.experiment.columns(term.effect, x.prediction)[:, 0, :]
            of_kind = offset if is_offset else friction
            of_kind[:, x.experiment.robot.joint_index(term.effect.scope[0])] += columns @ np.array(term.theta)
    cancels = rms(friction + offset, x.counted) < rms(friction, x.counted)
    return friction + np.where(cancels, offset, 0.0)


def _growth(search: ChangeSearch, chosen: Sequence[int], friction: Array) -> Array:
    """Return the share by which friction differs, less its variance, with its sign; NaN if unknown [1], shape (n,)."""
    x, evidence = search.differing, search.evidence
    out = np.full(friction.shape[1], np.nan)
    plain = [c for c, e in enumerate(evidence.effects) if is_plain(e.effect)]
    if not plain:
        return out
    asked = [*(c for c in chosen if not is_friction_of_joint(evidence.effects[c].effect)), *plain]
    parts = ParameterBlocks.of([evidence.effects[c] for c in asked])
    best, covariance = evidence.estimate(asked)
    for j, joint in enumerate(x.experiment.robot.joints):
        own = [k for k, c in enumerate(asked) if c in plain and evidence.effects[c].scope == (joint,)]
        along = np.where(x.counted[:, j], friction[:, j], 0.0)
        power = float(along @ along)
        if not own or power <= 0.0:
            continue
        per_unit = np.zeros(len(best))  # share of the friction for one unit of each parameter
        for k in own:
            per_unit[parts[k]] = along @ x.changes[evidence.effects[asked[k]]].columns[j] / power
        share, variance = float(per_unit @ best), float(per_unit @ covariance @ per_unit)
        out[j] = _beyond_chance(share, variance)
    return out


def _scales(search: ChangeSearch, chosen: Sequence[int]) -> Array:
    """Return the share by which the torque of each joint differs, as `_growth` does of friction [1], shape (n,)."""
    effects, fits = search.evidence.effects, search.evidence.fits(chosen)
    robot = search.differing.experiment.robot
    out = np.full(robot.n, np.nan)
    for c, effect in enumerate(effects):
        if isinstance(effect.effect, ActuatorGain) and effect.sign > 0 and c not in chosen:
            (share,) = fits.theta[c]
            variance = (share / max(fits.certainty[c], LEAST_CERTAINTY)) ** 2
            out[robot.joint_index(effect.effect.joint)] = _beyond_chance(share, variance)
    return out


def _beyond_chance(value: float, variance: float) -> float:
    """Return an estimate without what its variance explains of its square, with its sign."""
    return float(np.copysign(np.sqrt(max(value**2 - variance, 0.0)), value))


def as_phenomena(usual: Sequence[UsualFriction], causes: Sequence[Phenomenon]) -> tuple[Phenomenon, ...]:
    """Return usual differences of friction as one phenomenon, for people; nothing if there are none.

    Args:
        usual: The differences.
        causes: What was recognised in the changes. Where the drives are warmer or colder, friction did change.
    """
    told = {j for cause in causes if cause.kind in TEMPERATURE for j in cause.joints}
    untold = [u for u in usual if u.joint not in told]
    if not untold:
        return ()
    said = some([f"{100 * u.share:.2g} % on {u.joint}" for u in untold], 3)
    limits = [u.limit for u in untold]
    sentence = (
        f"friction differs by {said}; that is no change, because friction of an unchanged arm differs by up to "
        f"{100 * max(limits):.2g} % from run to run here"
    )
    values = {u.joint: u.share for u in untold}
    return (Phenomenon(PhenomenonKind.RUN_TO_RUN, tuple(values), sentence, values),)


def is_friction_of_joint(effect: Effect) -> bool:
    """Tell whether an effect is friction of one joint.

    Args:
        effect: The effect.
    """
    return effect.traits.dissipative and len(effect.scope) == 1
