"""Other names of an effect. Where another effect explains the logs as well, its name is not established.

That two drawings of one thing fit alike is no doubt of what it is: a spring beside an offset refines it, and a payload
and the last link are one body.
"""

from __future__ import annotations

from collections.abc import Iterable

from cdia_pin.effects import Effect, QuadraticFriction, Term, TorqueOffset, ViscousFriction, WrappedEffect
from cdia_pin.effects.refinements import REFINED, is_plain
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.robot.model import RobotModel

# kinds of effects, with the kinds that they draw more finely
FINER: dict[type[Effect], tuple[type[Effect], ...]] = {**REFINED, QuadraticFriction: (ViscousFriction,)}


def has_another_name(term: Term, confusions: Iterable[Confusion], robot: RobotModel) -> bool:
    """Tell whether other effects explain the logs as well as a term, and say something else of the arm.

    Args:
        term: The term.
        confusions: What the logs hardly distinguish from it.
        robot: The arm.
    """
    return bool(other_names(term, confusions, robot))


def other_names(term: Term, confusions: Iterable[Confusion], robot: RobotModel) -> list[Confusion]:
    """Return the other explanations of a term that say something else of the arm.

    Coulomb and viscous friction have no other name than each other's and that of an offset: every joint has friction,
    and what else resembles it is rarer. A joint that turns at one speed, or that reverses too fast for the filter, does
    not tell them apart; one that turns one way does not tell them from an offset.

    Args:
        term: The term.
        confusions: What the logs hardly distinguish from it.
        robot: The arm.
    """
    if is_plain(term.effect):
        return [c for c in confusions if len(c.effects) == 1 and _is_as_common(c.effects[0], term.effect)]
    return [c for c in confusions if len(c.effects) > 1 or not _same(term.effect, c.effects[0], robot)]


def _is_as_common(other: Effect, friction: Effect) -> bool:
    """Tell whether another effect than plain friction is as common: plain friction, or an offset of its joint."""
    return is_plain(other) or (isinstance(other, TorqueOffset) and other.scope == friction.scope)


def _same(named: Effect, other: Effect, robot: RobotModel) -> bool:
    """Tell whether another effect says the same of the arm: the same kind, a finer drawing of it, or the same body."""
    one, two = _inner(named), _inner(other)
    if isinstance(one, RigidBody) and isinstance(two, RigidBody):
        return one.carrier(robot) == two.carrier(robot)
    return one.scope == two.scope and type(one) in (type(two), *FINER.get(type(two), ()))


def _inner(effect: Effect) -> Effect:
    return _inner(effect.effect) if isinstance(effect, WrappedEffect) else effect
