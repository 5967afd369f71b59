"""A torque without a formula: radial bases in position and velocity, and a torque neuron."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.errors import EffectError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Unknown(JointEffect):
    """Learned torque, f = Σ lᵢ g(q−aᵢ) + Σ sᵢ g(q̇−bᵢ) + q̇ Σ dᵢ g(q−cᵢ) + h τ.

    g(x) is exp(−x²/σ²) in position and exp(−x²/ω²) in velocity. It says how large the missing torque is and where, not
    what it is. [Thesis] eq. 3.1 has no dᵢ: they are needed for a torque that depends on position and speed together,
    such as drag in one place.

    Attributes:
        joint: Name of the joint.
        position_centres: aᵢ [rad or m].
        velocity_centres: bᵢ [rad/s or m/s].
        damping_centres: cᵢ [rad or m].
        position_width: σ [rad or m].
        velocity_width: ω [rad/s or m/s].
    """

    position_centres: tuple[float, ...] = (-2.0, -1.0, 0.0, 1.0, 2.0)
    velocity_centres: tuple[float, ...] = (-1.0, -0.5, 0.0, 0.5, 1.0)
    position_width: float = 1.0
    velocity_width: float = 0.5
    damping_centres: tuple[float, ...] = ()

    name: ClassVar[str] = "unknown"
    plausibility: ClassVar[Plausibility] = Plausibility(searched=False)
    equation: ClassVar[str] = "Σ lᵢ g(q−aᵢ) + Σ sᵢ g(q̇−bᵢ) + q̇ Σ dᵢ g(q−cᵢ) + h τ"

    def __post_init__(self) -> None:
        # JSON gives lists; a frozen effect is hashable only with tuples
        for name in ("position_centres", "velocity_centres", "damping_centres"):
            centres = np.asarray(getattr(self, name), float)
            if centres.ndim != 1 or not np.isfinite(centres).all():
                raise EffectError(f"{self.label}: {name} must be a list of finite numbers")
            object.__setattr__(self, name, tuple(centres.tolist()))
        for name in ("position_width", "velocity_width"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise EffectError(f"{self.label}: {name} must be above 0, given {getattr(self, name)}")

    def __repr__(self) -> str:
        *of_each, _ = self.counts
        return f"Unknown(joint='{self.joint}', {' + '.join(str(k) for k in of_each if k)} neurons)"

    @property
    def traits(self) -> Traits:
        """Depends on the torque, and on position and velocity where it has neurons in them."""
        neurons = {
            Signal.POSITION: self.position_centres + self.damping_centres,
            Signal.VELOCITY: self.velocity_centres + self.damping_centres,
        }
        return Traits({Signal.TORQUE, *(signal for signal, centres in neurons.items() if centres)})

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """Number of neurons of each kind: in position, in velocity, damping, and the one of torque."""
        return len(self.position_centres), len(self.velocity_centres), len(self.damping_centres), 1

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """The weights: one per neuron, then the gain of the torque neuron."""
        at_q, at_v, damping, _ = self.counts
        return (
            *(Parameter(f"position_weight_{i + 1}", "{effort}") for i in range(at_q)),
            *(Parameter(f"velocity_weight_{i + 1}", "{effort}") for i in range(at_v)),
            *(Parameter(f"damping_weight_{i + 1}", "{effort}·s/{position}") for i in range(damping)),
            Parameter("torque_gain", "1", lower=-0.999, upper=10.0),
        )

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the activation of each neuron and the torque.

        Args:
            x: Signals of the joint, N samples.
        """
        at_q = [np.exp(-(((x.q - c) / self.position_width) ** 2)) for c in self.position_centres]
        at_v = [np.exp(-(((x.v - c) / self.velocity_width) ** 2)) for c in self.velocity_centres]
        damping = [np.exp(-(((x.q - c) / self.position_width) ** 2)) * x.v for c in self.damping_centres]
        return at_q + at_v + damping + [x.effort]

    def fitted_to(self, x: State, neurons: int = 7) -> Self:
        """Return the effect with its neurons, two or more of each kind, spread over the motion.

        Args:
            x: Motion and torques, N samples.
            neurons: Number of neurons in position, and in velocity.
        """
        neurons = max(neurons, 2)
        j = x.robot.joint_index(self.joint)
        q, v = np.ptp(x.q[:, j]) or 1.0, np.ptp(x.v[:, j]) or 1.0
        return self.with_shape(
            position_centres=tuple(np.linspace(x.q[:, j].min(), x.q[:, j].max(), neurons).tolist()),  # type: ignore[arg-type]
            velocity_centres=tuple(np.linspace(x.v[:, j].min(), x.v[:, j].max(), neurons).tolist()),  # type: ignore[arg-type]
            position_width=float(q / (neurons - 1)),
            velocity_width=float(v / (neurons - 1)),
        )

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return the effect spread over the motion.

        Args:
            x: Motion and torques, N samples.
        """
        return [self.fitted_to(x)]
