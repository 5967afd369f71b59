"""A prediction: the torque of a model along the logs of an experiment, and what it leaves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.torques import Torques
from cdia_pin.effects import ALWAYS, Effect, Profile, Term
from cdia_pin.errors import EffectError

Array = NDArray[np.float64]

SAME_GAIN = 1e-9  # difference of a gain [1] that is rounding


@dataclass(frozen=True, repr=False)
class Prediction:
    """The torque that a model predicts for an experiment.

    Attributes:
        model: The model.
        torques: Torques along each segment.
        residual: Predicted minus measured torque at the compared samples of all segments [N·m or N], shape (K, n).
    """

    model: Dynamics
    torques: tuple[Torques, ...]
    residual: Array

    def __repr__(self) -> str:
        return f"Prediction({self.model!r}, {len(self.residual)} compared samples)"

    @cached_property
    def present(self) -> dict[Effect, Term]:
        """Terms of the model by their effect.

        Raises:
            EffectError: If two terms have the same effect, because normal equations name parameters by it.
        """
        out: dict[Effect, Term] = {}
        for term in self.model.terms:
            if term.effect in out:
                raise EffectError(
                    f"{term.label} is in the model twice; a model is fitted to logs with each effect once"
                )
            out[term.effect] = term
        return out

    def profile(self, effect: Effect) -> Profile:
        """Return the profile of the model's term of an effect; always present if the model has none.

        Args:
            effect: The effect.
        """
        return self.present[effect].profile if effect in self.present else ALWAYS

    @cached_property
    def gains(self) -> tuple[Array, NDArray[np.bool_]]:
        """Mean gain of each joint's torque [1], exactly one without gains, and True where it varies, shapes (n,)."""
        gain = np.concatenate([t.gain for t in self.torques])
        mean = gain.mean(axis=0)
        return np.where(np.abs(mean - 1.0) <= SAME_GAIN, 1.0, mean), np.ptp(gain, axis=0) > SAME_GAIN
