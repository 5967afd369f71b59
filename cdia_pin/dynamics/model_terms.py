"""A robot with terms: how models are composed, and which of their terms act where."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

from cdia_pin.effects import Channel, Effect, Signal, Term, parse_effect
from cdia_pin.errors import ModelError
from cdia_pin.logs.motion import Motion
from cdia_pin.phrases import shortened, some
from cdia_pin.robot.model import RobotModel


@dataclass(frozen=True, repr=False)
class ModelTerms:
    r"""A robot and the terms :math:`\sum \beta \Phi \theta` of its model.

    Attributes:
        robot: The rigid bodies of the URDF.
        terms: Terms Σ β Φ θ that are added to them.
        learned_from: Conditioned logs that the terms were fitted to, if any; later logs are compared with them.
    """

    robot: RobotModel
    terms: tuple[Term, ...] = ()
    learned_from: tuple[Motion, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        for term in self.terms:
            term.check(self.robot)

    def __repr__(self) -> str:
        terms = some([shortened(t.label, 50) for t in self.terms], 2)
        return f"{type(self).__name__}({shortened(self.robot.name)}, {f'terms {terms}' if terms else 'no terms'})"

    # ------------------------------------------------------------- composing

    def add(self, *terms: Term) -> Self:
        """Return the model with more terms; a term of the same effect and scope is replaced.

        Args:
            terms: Terms to add.

        Returns:
            A new model; this one is not changed.
        """
        labels = {t.label for t in terms}
        kept = tuple(t for t in self.terms if t.label not in labels)
        return replace(self, terms=kept + terms)

    def remove(self, label: str) -> Self:
        """Return the model without a term.

        Args:
            label: Label of the term, such as ``coulomb_friction@elbow_joint``.

        Returns:
            A new model; this one is not changed.

        Raises:
            ModelError: If no term has this label.
        """
        kept = tuple(t for t in self.terms if t.label != label)
        if len(kept) == len(self.terms):
            have = ", ".join(t.label for t in self.terms) or "none"
            raise ModelError(f"the model has no term '{label}'; its terms: {have}")
        return replace(self, terms=kept)

    def without(self, labels: Collection[str]) -> Self:
        """Return the model without some terms; the model itself if it has none of them.

        Args:
            labels: Labels of terms.
        """
        kept = tuple(t for t in self.terms if t.label not in labels)
        return self if len(kept) == len(self.terms) else replace(self, terms=kept)

    def find(self, label: str) -> Term:
        """Find a term by its label.

        Args:
            label: Label of the term, such as ``coulomb_friction@elbow_joint``.

        Returns:
            The term.

        Raises:
            ModelError: If no term has this label.
        """
        known = {t.label: t for t in self.terms}
        if label not in known:
            label = parse_effect(label, self.robot).label
        if label in known:
            return known[label]
        raise ModelError(f"the model has no term '{label}'")

    # ------------------------------------------------------------- terms by their physics

    @property
    def turns_gravity(self) -> bool:
        """True if terms change the gravity that acts on the arm."""
        return bool(self._turning)

    def moves(self, effect: Effect) -> bool:
        """Tell whether terms move the positions that an effect sees from those that the encoders read.

        Args:
            effect: The effect, in the model or not.
        """
        at_true_positions = effect.traits.channel not in (Channel.POSITION_READING, Channel.TORQUE_READING)
        sees = at_true_positions and Signal.POSITION in effect.traits.depends_on
        return sees and bool(self.on(Channel.POSITION_READING))

    def reads_otherwise(self, effect: Effect) -> bool:
        """Tell whether terms change how the torque of an effect is read: later, for one.

        Args:
            effect: The effect, in the model or not.
        """
        return effect.traits.channel is not Channel.TORQUE_READING and bool(self.on(Channel.TORQUE_READING))

    def on(self, channel: Channel) -> tuple[Term, ...]:
        """Return the terms of a channel.

        Args:
            channel: Place in the equations where the terms act.

        Returns:
            The terms, in the order of the model.
        """
        return tuple(t for t in self.terms if t.effect.traits.channel is channel)

    @cached_property
    def on_motion(self) -> tuple[Term, ...]:
        """Terms that act on the arm itself, not on its sensors."""
        return self.on(Channel.JOINT_TORQUE)

    @cached_property
    def inertial(self) -> tuple[Term, ...]:
        """Terms on the arm whose torque depends on its acceleration."""
        return tuple(t for t in self.on_motion if Signal.ACCELERATION in t.depends_on)

    @cached_property
    def _turning(self) -> tuple[Term, ...]:
        return tuple(t for t in self.terms if t.effect.traits.turns_gravity)
