"""Slopes of shapes: the derivative of a term's torque by its shape, so that intervals allow for fitted shapes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ALWAYS, Effect, Parameter, Profile, State, Traits, WrappedEffect
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STEP = 1e-4  # relative step of the central difference [1]: its error is about 1e-8, its rounding 1e-12


@dataclass(frozen=True)
class Slope(WrappedEffect):
    """The change of a term's torque with its shape, to first order: f = ∂(Φ θ)/∂s Δs.

    A fit of the term together with its slope is a fit of θ and s.

    Attributes:
        effect: The term's effect.
        theta: The term's parameters.
        of_shape: Name of the shape parameter s.
        limits: Least and largest Δs, in the unit of the shape.
        profile: Where the term is present.
    """

    effect: Effect
    theta: tuple[float, ...]
    of_shape: str
    limits: tuple[float, float] = (-np.inf, np.inf)
    profile: Profile = ALWAYS

    name = "slope"
    equation = "∂(Φ θ)/∂s Δs"
    shape = ()
    bodies = ()

    @property
    def traits(self) -> Traits:
        """Signals and channel of the effect; a slope is linear, has either sign and leaves gravity as it is."""
        inner = self.effect.traits
        signals = self.profile.depends_on.union(inner.depends_on)
        return replace(inner, depends_on=signals, linear=True, dissipative=False, turns_gravity=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """Δs, in the unit of the shape."""
        unit = next(p.unit for p in self.effect.shape if p.name == self.of_shape)
        lower, upper = self.limits
        return (Parameter(self.of_shape, unit, lower=lower, upper=upper),)

    @property
    def label(self) -> str:
        """The effect's label and the shape, ``stribeck_friction@elbow_joint: decay``."""
        return f"{self.effect.label}: {self.of_shape}"

    def basis(self, x: State) -> Array:
        """Return ∂(Φ θ)/∂s by central differences; at a bound of s by a one-sided difference.

        Args:
            x: State along the motion, N samples.

        Returns:
            Torque per unit of the shape [N·m or N per unit], shape (N, n, 1).
        """
        here, theta = self.effect.shape_values[self.of_shape], np.array(self.theta)
        below, above = (self._at(here + step * self._size) for step in (-STEP, STEP))
        apart = above.shape_values[self.of_shape] - below.shape_values[self.of_shape]
        slope = np.asarray((above.torque(x, theta) - below.torque(x, theta))[:, :, None] / apart)
        return slope if self.profile == ALWAYS else self.profile(x)[:, None, None] * slope

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the size of the shape, because the shape was searched for in a range of about that width.

        Args:
            robot: The robot; not used.

        Returns:
            Prior standard deviation of Δs, shape (1,).
        """
        return np.array([self._size])

    # the other methods are those of a linear effect
    torque, jacobian, bounds, units = Effect.torque, Effect.jacobian, Effect.bounds, Effect.units
    is_physical, nearest_physical = Effect.is_physical, Effect.nearest_physical
    is_distinct, shift, gravity_change = Effect.is_distinct, Effect.shift, Effect.gravity_change
    shape_values, with_shape, shape_grid = Effect.shape_values, Effect.with_shape, Effect.shape_grid

    @property
    def _size(self) -> float:
        """Absolute value of the shape, in its unit; one where it is zero."""
        return abs(self.effect.shape_values[self.of_shape]) or 1.0

    def _at(self, value: float) -> Effect:
        try:
            return self.effect.with_shape(**{self.of_shape: value})
        except EffectError:
            return self.effect


def slopes(model: Dynamics) -> Iterator[Slope]:
    """Yield the slope of each shape of a model's terms.

    Args:
        model: The model.
    """
    for term in model.terms:
        for name in term.effect.shape_values:
            yield Slope(term.effect, term.theta, name, profile=term.profile)
