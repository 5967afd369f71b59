r"""Effects whose parameters vary: from log to log, or slowly within one.

.. math:: f = \Phi(x) \sum_k w_k(x)\,\theta_k, \qquad \sum_k w_k = 1

Each θₖ is a full set of the effect's parameters, with its units and bounds; where all of them are equal, the effect
is the plain one.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.records import EffectRecord
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Channel
from cdia_pin.effects.wrapped import WrappedEffect
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class Varying(WrappedEffect):
    """An effect that has its parameters several times: a subclass says where which of them hold.

    Subclasses are frozen dataclasses whose first field is the effect.
    """

    kind: ClassVar[str]  # what the parameters vary with

    def __post_init__(self) -> None:
        if self.effect.traits.channel is Channel.POSITION_READING:
            raise EffectError(f"{self.effect.label}: the zero of an encoder cannot vary with {self.kind}")

    # ------------------------------------------------------------- what a subclass gives

    @property
    @abstractmethod
    def parts(self) -> tuple[str, ...]:
        """What each set of parameters is called."""

    @abstractmethod
    def weights(self, x: State) -> Array:
        """Return wₖ at each sample, each row adding up to one, shape (N, number of parts).

        Args:
            x: Motion and torques, N samples.
        """

    @abstractmethod
    def variation(self) -> dict[str, Any]:
        """Return a JSON-ready description of how the parameters vary; `cdia_pin.effects.varied` reads it back."""

    # ------------------------------------------------------------- what differs from the plain effect

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """The effect's parameters, once for each part."""
        return tuple(
            replace(p, name=f"{p.name}[{part}]") for part in self.parts for p in self.effect.parameters
        )

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """The effect's bodies, once for each part: each of them is possible by itself."""
        return self.effect.bodies * len(self.parts)

    def of_part(self, theta: Sequence[float] | Array, part: str) -> tuple[float, ...]:
        """Return the effect's parameters in one part, shape (p of the effect,).

        Args:
            theta: Parameters of all parts, one part after another, shape (p,).
            part: Name of the part, one of `parts`.
        """
        return tuple(float(v) for v in self._split(np.asarray(theta))[self.parts.index(part)])

    def mean(self, theta: Sequence[float] | Array) -> tuple[float, ...]:
        """Return the mean of the parts' parameters, shape (p of the effect,).

        Args:
            theta: Parameters of all parts, one part after another, shape (p,).
        """
        return tuple(float(v) for v in self._split(np.asarray(theta)).mean(axis=0))

    def basis(self, x: State) -> Array:
        """Return Φ with each part's weight, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        return self._weighted(x, [self.effect.basis(x)] * len(self.parts))

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        w = self.weights(x)
        if self.effect.traits.linear:
            return np.asarray(np.einsum("nip,np->ni", self.effect.basis(x), w @ self._split(theta)))
        parts = [self.effect.torque(x, part) for part in self._split(theta)]
        return np.asarray(np.einsum("nk,kni->ni", w, np.stack(parts)))

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self._weighted(x, [self.effect.jacobian(x, part) for part in self._split(theta)])

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return by how much gravity differs from the robot's in the parts that hold [m/s²], shape (N, 3).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        parts = [self.effect.gravity_change(x, part) for part in self._split(theta)]
        return np.asarray(np.einsum("nk,kng->ng", self.weights(x), np.stack(parts)))

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the effect's bounds, once for each part.

        Args:
            robot: The arm, n joints.
        """
        lower, upper = self.effect.bounds(robot)
        return np.tile(lower, len(self.parts)), np.tile(upper, len(self.parts))

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether the parameters of every part can belong to a real arm.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        return all(self.effect.is_physical(part, robot) for part in self._split(theta))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the physical parameters next to an estimate, shape (p,).

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        return np.concatenate([self.effect.nearest_physical(p, robot) for p in self._split(theta)])

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the effect's prior standard deviations, once for each part, shape (p,).

        Args:
            robot: The arm, n joints.
        """
        return np.tile(self.effect.prior_scale(robot), len(self.parts))

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether every part is more than a simpler effect.

        Args:
            theta: Parameters θ, shape (p,).
        """
        return all(self.effect.is_distinct(part) for part in self._split(theta))

    @property
    def label(self) -> str:
        """The effect's label and what its parameters vary with, ``coulomb_friction@elbow_joint[log]``."""
        return f"{self.effect.label}[{self.kind}]"

    def units(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the unit of each parameter on this robot.

        Args:
            robot: The arm, n joints.
        """
        return self.effect.units(robot) * len(self.parts)

    def to_dict(self) -> EffectRecord:
        """Return a JSON-ready description: the effect's own, and how its parameters vary."""
        return {**self.effect.to_dict(), "varies": self.variation()}

    def _split(self, theta: Array) -> Array:
        return np.reshape(theta, (len(self.parts), self.effect.size))

    def _weighted(self, x: State, phi: Sequence[Array]) -> Array:
        w = self.weights(x)
        return np.concatenate([w[:, k, None, None] * p for k, p in enumerate(phi)], axis=2)
