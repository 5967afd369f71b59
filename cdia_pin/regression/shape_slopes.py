"""Slopes of shapes: how a term's torque changes with its shape, so that intervals know what searching for it cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Parameter, State
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STEP = 1e-4  # [1], relative, to differentiate by a shape


@dataclass(frozen=True)
class Slope(Effect):
    """The change of a term's torque with its shape, to first order: f = ∂(Φ θ)/∂s Δs.

    Beside the term it is what makes a fit one of θ and s together.

    Attributes:
        effect: The term's effect.
        theta: The term's parameters.
        of_shape: Name of the shape parameter s.
    """

    effect: Effect
    theta: tuple[float, ...]
    of_shape: str

    name: ClassVar[str] = "slope"
    equation: ClassVar[str] = "∂(Φ θ)/∂s Δs"
    of_torque: ClassVar[bool] = True  # it hangs on the model's present parameters, as the torque does

    def __post_init__(self) -> None:
        object.__setattr__(self, "reads", self.effect.reads)
        object.__setattr__(self, "parameters", (Parameter(self.of_shape, ""),))

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints named by the effect."""
        return self.effect.scope

    def basis(self, x: State) -> Array:
        """Return ∂(Φ θ)/∂s by central differences, shape (N, n, 1); by one side at a bound of s."""
        here, theta = self.effect.shape_values[self.of_shape], np.array(self.theta)
        below, above = (self._at(here * (1 + step)) for step in (-STEP, STEP))
        apart = above.shape_values[self.of_shape] - below.shape_values[self.of_shape]
        return np.asarray((above.torque(x, theta) - below.torque(x, theta))[:, :, None] / apart)

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of the joints whose torque the effect can change."""
        return self.effect.acts_on(robot)

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the shape's own value: it was searched for in a range, and is not further off than that."""
        return np.array([abs(self.effect.shape_values[self.of_shape])])

    def _at(self, value: float) -> Effect:
        try:
            return self.effect.with_shape(**{self.of_shape: value})
        except EffectError:
            return self.effect


def slopes(model: Dynamics) -> Iterator[Slope]:
    """Yield the slope of each shape of a model's terms."""
    for term in model.terms:
        for name in term.effect.shape_values:
            yield Slope(term.effect, term.theta, name)
