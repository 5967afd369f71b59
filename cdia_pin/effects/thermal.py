"""Friction that falls as the joint warms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.friction import VISCOUS
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import ROOM_TEMPERATURE, JointState, State
from cdia_pin.effects.traits import SensedFrom, Signal, Traits

Array = NDArray[np.float64]

# Decays that are tried [1/K]: lubricants halve their viscosity within 10 to 70 K [Bittencourt2012].
SLOWEST, FASTEST, TRIED = 0.01, 0.07, 4
LEAST_WARMING = 3.0  # [K], a joint that warms by less changes its friction by less than fits resolve


@dataclass(frozen=True)
class ThermalFriction(JointEffect):
    """Coulomb and viscous friction that fall with temperature, f = −(α sgn q̇ + β q̇) exp(−κ (T − 20 °C)).

    Level and coefficient are those at 20 °C [Bittencourt2012]. It needs a log with the temperature of the joint. In a
    plant or a model whose temperature nobody gives, the joint is at 20 °C.

    Attributes:
        decay: κ, share by which the friction falls with each kelvin [1/K].
    """

    decay: float = 0.03

    name: ClassVar[str] = "thermal_friction"
    equation: ClassVar[str] = "−(α sgn(q̇) + β q̇) exp(−κ (T − 20 °C))"
    traits: ClassVar[Traits] = Traits(
        {Signal.VELOCITY, Signal.DIRECTION, Signal.TEMPERATURE}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=3.0)  # most logs are shorter than a warm-up
    parameters = (Parameter("level", "{effort}", lower=0.0), Parameter("coefficient", VISCOUS, lower=0.0))
    shape = (Parameter("decay", "1/K", lower=1e-4, upper=1.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of level and coefficient.

        Args:
            x: Signals of the joint with its temperature, N samples.
        """
        share = np.exp(-self.decay * (x.temperature - ROOM_TEMPERATURE))
        return [-x.sign * share, -x.v * share]

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return decays of usual lubricants; none if nobody measured a temperature, or the joint hardly warms.

        Args:
            x: Motion and torques, N samples.
        """
        if x.temperature is None or np.ptp(x.temperature[:, x.robot.joint_index(self.joint)]) < LEAST_WARMING:
            return []
        return [self.with_shape(decay=float(k)) for k in np.geomspace(SLOWEST, FASTEST, TRIED)]
