"""Effects drawn from a seed: joint, sign and shape; the size is given afterwards."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.recordings import ARMS
from benchmarks.real_residuals.sizing import NoSizeError, sized
from cdia_pin.effects import EFFECTS, Effect, SensedFrom, Term
from cdia_pin.robot.inertia import at_centre_of_mass, parameters_of

Array = NDArray[np.float64]

LOADED = 0.3  # [1], rigid-body torque over the measured one; below it a joint's torque is friction, and a gain is too
CENTRE = (
    0.08  # [m], furthest that an added body is drawn from the tool or from the link's centre, along each axis
)
OWN = 0.5  # [1], share of its size that a link must have on its own joint; else it is the same body on the one before
RADIUS = 0.05  # [m], of an added body, a ball
BALL = 0.4  # [1], inertia of a ball over m r²


@dataclass(frozen=True)
class Place:
    """A joint of a log on which an effect is drawn.

    Attributes:
        along: The log.
        joint: Name of the joint.
        rng: The draw.
    """

    along: FilteredLog
    joint: str
    rng: np.random.Generator

    @property
    def j(self) -> int:
        """Index of the joint."""
        return self.along.robot.joint_index(self.joint)

    @property
    def fast(self) -> float:
        """Speed that the joint exceeds in a twentieth of the time [rad/s or m/s]."""
        return float(self.along.fast[self.j])

    def between(self, low: float, high: float) -> float:
        """Draw a number."""
        return float(self.rng.uniform(low, high))

    def sign(self) -> float:
        """Draw a sign."""
        return float(self.rng.choice([-1.0, 1.0]))

    def effect(self, name: str, **shape: float) -> Effect:
        """Return an effect on the joint."""
        return EFFECTS[name].from_scope([self.joint], shape)


Recipe = Callable[[Place], Term]


def _one(name: str, *, either_way: bool = False) -> Recipe:
    """Return the recipe of an effect with one parameter; its sign is drawn if it may be either."""

    def recipe(at: Place) -> Term:
        size = 0.02 * (at.sign() if either_way else 1.0)
        return Term(at.effect(name), (size,))

    return recipe


def _stribeck(at: Place) -> Term:
    speed = at.between(0.08, 0.25) * at.fast
    effect = at.effect("stribeck_friction", decay=1.0 / speed)
    return Term.of(effect, level=1.0, breakaway=at.between(0.7, 2.0))


def _bearing(at: Place) -> Term:
    return Term.of(at.effect("bearing_friction"), level=1.0, coefficient=at.between(0.2, 1.0) / at.fast)


def _asymmetric(at: Place) -> Term:
    more, low, high = at.between(1.6, 2.5), *(at.between(0.2, 1.0) / at.fast for _ in range(2))
    forth, back = (1.0, more) if at.sign() > 0 else (more, 1.0)
    return Term(at.effect("asymmetric_friction"), (forth, back, low, high))


def _ripple(at: Place) -> Term:
    effect, phase = at.effect("position_ripple", frequency=at.between(5.0, 14.0)), at.between(0, 2 * np.pi)
    return Term.of(effect, sine=float(np.cos(phase)), cosine=float(np.sin(phase)))


def _spring(at: Place) -> Term:
    q = at.along.state.q[:, at.j]
    rest = at.between(float(q.min()), float(q.max()))
    return Term.of(at.effect("joint_spring"), stiffness=1.0, preload=rest)


def _coupled(at: Place) -> Term:
    """Return friction with the next joint towards the tool, or with the one before at the tool."""
    joints = at.along.robot.joints
    first = min(at.j, len(joints) - 2)
    effect = EFFECTS["coupled_friction"].from_scope(joints[first : first + 2], {})
    return Term.of(effect, level=1.0, coefficient=at.between(0.2, 1.0) / at.fast)


def _link(at: Place) -> Term:
    """Return a body near the centre of mass of the link, where most of what a URDF leaves out is."""
    _, centre, _ = at_centre_of_mass(at.along.robot.inertial_parameters[at.j])
    return Term(at.effect("link_inertia"), _body(at, centre))


def _payload(at: Place) -> Term:
    return Term(EFFECTS["payload"].from_scope([], {}), _body(at, np.zeros(3)))


def _delay(at: Place) -> Term:
    return Term(EFFECTS["effort_delay"].from_scope([], {}), (0.005 * at.sign(),))


def _body(at: Place, near: Array) -> tuple[float, ...]:
    centre = near + at.rng.uniform(-CENTRE, CENTRE, 3)
    return tuple(map(float, parameters_of(1.0, centre, BALL * RADIUS**2 * np.eye(3))))


RECIPES: dict[str, Recipe] = {
    "coulomb_friction": _one("coulomb_friction"),
    "viscous_friction": _one("viscous_friction"),
    "bearing_friction": _bearing,
    "stribeck_friction": _stribeck,
    "asymmetric_friction": _asymmetric,
    "quadratic_friction": _one("quadratic_friction"),
    "load_friction": _one("load_friction"),
    "position_ripple": _ripple,
    "actuator_gain": _one("actuator_gain", either_way=True),
    "torque_offset": _one("torque_offset", either_way=True),
    "rotor_inertia": _one("rotor_inertia"),
    "joint_spring": _spring,
    "coupled_friction": _coupled,
    "link_inertia": _link,
    "payload": _payload,
    "encoder_offset": _one("encoder_offset", either_way=True),
    "effort_delay": _delay,
}
# what a sensor behind the gear cannot see
OF_THE_MOTOR = {e for e in RECIPES if EFFECTS[e].traits.sensed is SensedFrom.MOTOR}
OF_THE_LOAD = {"load_friction", "actuator_gain"}  # those that need a joint that carries something


def drawn(
    effect: str,
    wanted: float,
    before: FilteredLog,
    after: FilteredLog,
    seed: int,
    joints: Sequence[str] | None = None,
) -> Term:
    """Draw an effect of a given size, on a joint that moves in both logs.

    Args:
        effect: Its name.
        wanted: RMS torque over that of the joint on which it is largest [1].
        before: The log without it.
        after: The log that it is to be put into.
        seed: Of joint, sign and shape.
        joints: Names of the joints that are drawn from; all if None.

    Raises:
        NoSizeError: If it can have that size on no joint.
    """
    rng = np.random.default_rng(seed)
    for joint in rng.permutation(after.robot.joints if joints is None else joints).tolist():
        if not _can_have(effect, joint, before, after):
            continue
        try:
            term = sized(RECIPES[effect](Place(after, joint, rng)), wanted, after)
        except NoSizeError:  # too little torque of this kind on this joint
            continue
        if effect != "link_inertia" or _on_its_joint(term, joint, after) >= OWN * wanted:
            return term
    raise NoSizeError(f"{effect} cannot have {wanted:.0%} of the torque of any joint in {after.log.source}")


def can_be_seen(effect: str, arm: str) -> bool:
    """Tell whether the sensors of an arm can see an effect."""
    return SensedFrom.of(ARMS[arm].behind_gear).meets(EFFECTS[effect].traits.sensed)


def _can_have(effect: str, joint: str, before: FilteredLog, after: FilteredLog) -> bool:
    j = after.robot.joint_index(joint)
    if effect == "link_inertia":  # of the first link a motion shows a rotor, and the last one's is a payload
        return 0 < j < after.robot.n - 1
    if effect in OF_THE_LOAD and after.rigid_share[j] < LOADED:
        return False
    return bool(before.moving[j] and after.moving[j])


def _on_its_joint(term: Term, joint: str, along: FilteredLog) -> float:
    """Return the RMS torque of an effect over that of one joint [1]."""
    j = along.robot.joint_index(joint)
    return float(along.size(Insertion(term, along).torque())[j] / along.torque_rms[j])
