"""The terms of an identification: every link, and the friction, offset and rotor of every joint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    ActuatorGain,
    AsymmetricFriction,
    BearingFriction,
    CoulombFriction,
    Effect,
    Expression,
    JointSpring,
    LinkInertia,
    LinkInertias,
    LoadFriction,
    Payload,
    RotorInertia,
    State,
    StribeckFriction,
    Term,
    TorqueOffset,
    ViscousFriction,
)
from cdia_pin.identification.identification_settings import IdentificationSettings
from cdia_pin.regression.experiment import Experiment, rms

SATURATION = (0.05, 0.15, 0.45)  # speeds at which friction levels off, over the fastest speed driven [1]
# What a joint has that moves; a torque sensor shows either the drive's friction and its rotor, or the bearings alone.
FRICTION_AND_ROTOR = (CoulombFriction, ViscousFriction, RotorInertia, BearingFriction)
SPANNED_BY: dict[type[Effect], tuple[type[Effect], ...]] = {
    CoulombFriction: (StribeckFriction, AsymmetricFriction, BearingFriction),
    ViscousFriction: (AsymmetricFriction, BearingFriction),
    BearingFriction: (
        CoulombFriction,
        ViscousFriction,
    ),  # a model of logs of the other side has the one or the other
    TorqueOffset: (JointSpring,),
}


@dataclass(frozen=True)
class Refinement:
    """A richer law for one joint.

    Attributes:
        added: The effect.
        replaced: Labels of the terms that it contains.
    """

    added: Effect
    replaced: tuple[str, ...] = ()

    def of(self, model: Dynamics) -> Dynamics:
        """Return the model with the law at zero parameters, without the terms that it replaces.

        Args:
            model: The present model.
        """
        for label in self.replaced:
            model = model.remove(label)
        return model.add(Term(self.added, (0.0,) * self.added.size))


def full_model(
    model: Dynamics, experiment: Experiment, settings: IdentificationSettings | None = None
) -> Dynamics:
    """Return a model with all terms of an identification; terms of the given model keep their parameters.

    A joint that hardly moves gets no friction and no rotor. One whose torque is measured behind the gear gets friction
    of its bearings and no rotor.

    Args:
        model: The model as it is known.
        experiment: The conditioned logs.
        settings: When a joint counts as moving.
    """
    settings = settings or IdentificationSettings()
    robot, model = model.robot, _one_by_one(model)
    has_payload = any(isinstance(t.effect, Payload) for t in model.terms)
    wanted: list[Effect] = [
        LinkInertia(j) for j in robot.joints if not (has_payload and j == robot.tool_joint)
    ]
    for joint, moves in zip(robot.joints, moving_joints(experiment, settings.least_motion), strict=True):
        wanted.append(TorqueOffset(joint))
        if moves:
            wanted += [e for e in (kind(joint) for kind in FRICTION_AND_ROTOR) if experiment.sees(e)]
    present = {t.label for t in model.terms}
    missing = [e for e in wanted if not present & {e.label, *_spanning(e)}]
    return model.add(*(Term(e, (0.0,) * e.size) for e in missing))


def _one_by_one(model: Dynamics) -> Dynamics:
    """Return a model in which an effect of several links is one term per link."""
    several = [(t, t.effect) for t in model.terms if isinstance(t.effect, LinkInertias)]
    for term, effect in several:
        model = model.remove(term.label)
        for link, theta in effect.by_body(np.array(term.theta)):
            given = next((t for t in model.terms if t.effect == link), None)
            model = model.remove(link.label) if given else model
            total = theta + (np.array(given.theta) if given else 0.0)
            model = model.add(Term(link, tuple(total), term.profile))
    return model


def moving_joints(experiment: Experiment, least_share: float) -> NDArray[np.bool_]:
    """Return True for joints that move for long enough to show their friction and rotor.

    Args:
        experiment: The conditioned logs.
        least_share: Share of the samples in which such a joint moves [1].

    Returns:
        Shape (n,).
    """
    return np.asarray(experiment.moving.mean(axis=0) >= least_share)


def refinements(
    model: Dynamics, experiment: Experiment, settings: IdentificationSettings
) -> Iterator[Refinement]:
    """Yield the richer laws that a model may get, each for one joint.

    Args:
        model: The present model.
        experiment: The conditioned logs.
        settings: Which joints move, and carry enough load.
    """
    present = {t.label for t in model.terms}
    saturating = {t.effect.joint for t in model.terms if isinstance(t.effect, Expression)}
    along = experiment.along(experiment.predict(model))
    load = np.vstack([s.motion.compared(s.state.rigid_torque) for s in experiment.segments])
    whole = rms(experiment.measured, experiment.informative)
    loaded = rms(load, experiment.informative) > settings.least_rigid_share * whole
    moving = moving_joints(experiment, settings.least_motion)
    for j, joint in enumerate(model.robot.joints):
        if not moving[j]:
            continue
        for law in _laws(joint, along, bool(loaded[j])):
            levels_off = isinstance(law, Expression)
            known = bool({law.label, *_spanning(law)} & present) or (levels_off and joint in saturating)
            if known or not experiment.sees(ViscousFriction(joint) if levels_off else law):
                continue
            spanned = {e(joint).label for e, by in SPANNED_BY.items() if isinstance(law, by)}  # type: ignore[call-arg]
            yield Refinement(law, tuple(sorted(spanned & present)))


def saturating_friction(joint: str, along: State, share: float) -> Expression:
    """Return friction that grows with speed and levels off, −α tanh(q̇/w), as in lubricated gears [Makkar2005].

    Args:
        joint: Name of the joint.
        along: State along the motion.
        share: w over the 95th percentile of the joint's speed [1].
    """
    fast = np.percentile(np.abs(along.v[:, along.robot.joint_index(joint)]), 95)
    return Expression(joint, f"-tanh(dq/{share * fast:.2g})")


def _laws(joint: str, along: State, loaded: bool) -> Iterator[Effect]:
    yield from (saturating_friction(joint, along, share) for share in SATURATION)
    yield from StribeckFriction(joint).shape_grid(along)
    if loaded:
        yield LoadFriction(joint)
        yield ActuatorGain(joint)


def _spanning(effect: Effect) -> set[str]:
    """Return the labels of effects that contain this one as a special case."""
    return {e(*effect.scope).label for e in SPANNED_BY.get(type(effect), ())}
