"""Friction that grows with the transmitted torque and falls as speed grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.friction import LARGEST_DECAY, LEAST_BREAKAWAY, LoadFriction, stribeck_decays
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.traits import SensedFrom, Signal, Traits

Array = NDArray[np.float64]

TRIED = 4  # decays [1]: a column of the load cannot be kept between fits, and a parabola finds the rest


@dataclass(frozen=True)
class LoadStribeckFriction(JointEffect):
    """Dry friction in proportion to the load that falls with speed, f = −(α₀ + α₁ exp(−β|q̇|)) |τ| sgn q̇.

    Gears under load have it [Duclusaud2025]. With `stribeck_friction` and `viscous_friction` beside it
    it is the extended law of servo actuators. At α₁ = 0 it is `load_friction`.

    Attributes:
        decay: β, inverse of the Stribeck speed [s/rad or s/m].
    """

    decay: float = 10.0

    name: ClassVar[str] = "load_stribeck_friction"
    equation: ClassVar[str] = "−(α₀ + α₁ exp(−β|q̇|)) |τ| sgn(q̇)"
    traits: ClassVar[Traits] = Traits(
        {Signal.TORQUE, Signal.VELOCITY, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=3.0)  # either dependence alone is more common
    parameters = (
        Parameter("coefficient", "1", lower=0.0, upper=1.0),
        Parameter("breakaway", "1", lower=0.0, upper=1.0),
    )
    shape = (Parameter("decay", "s/{position}", lower=1e-3, upper=LARGEST_DECAY),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of the coefficient and of its breakaway part.

        Args:
            x: Signals of the joint, N samples.
        """
        load = -np.abs(x.effort) * x.sign
        return (load, np.exp(-self.decay * np.abs(x.v)) * load)

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether the fall with speed counts, otherwise it is `load_friction`.

        Args:
            theta: (coefficient, breakaway) [1].
        """
        coefficient, breakaway = theta
        return bool(breakaway >= LEAST_BREAKAWAY * coefficient)

    @property
    def simpler(self) -> LoadFriction:
        """Friction of one coefficient, where the fall with speed does not count."""
        return LoadFriction(self.joint)

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return decays that the motion can show, see `stribeck_decays`.

        Args:
            x: Motion and torques, N samples.
        """
        return [self.with_shape(decay=d) for d in stribeck_decays(x, self.joint, TRIED)]
