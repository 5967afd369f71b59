"""Does the SCARA arm that ships equal the thesis' closed form, and how far off is the form as printed?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.robot import load_robot, scara

Array = NDArray[np.float64]

TOLERANCE = 1e-11  # of the corrected form against Pinocchio, in the unit of each term
SPEED = np.pi * np.array([10 / 3, 5, 55 / 3, 1.2 / np.pi])  # [rad/s, rad/s, rad/s, m/s], Table 1


@dataclass(frozen=True)
class Agreement:
    """How one term of the dynamics agrees with Pinocchio's on the URDF.

    Attributes:
        term: Name.
        unit: Of the differences.
        corrected: Largest difference of the closed form that ships.
        printed: Largest difference of the form as the thesis prints it.
    """

    term: str
    unit: str
    corrected: float
    printed: float


@dataclass(frozen=True)
class ScaraModelStudy:
    """Result of `scara_model_study`.

    Attributes:
        states: How many states were drawn.
        seed: Of the states.
        agreements: M, V, G, then the power balance.
    """

    states: int
    seed: int
    agreements: tuple[Agreement, ...]

    @property
    def agrees(self) -> bool:
        """Whether M, V and G that ship are those of the URDF."""
        return all(a.corrected <= TOLERANCE for a in self.agreements[:3])

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``cdia study scara-model --json`` writes it."""
        return {
            "schema": schemas.STUDY_SCARA_MODEL,
            "robot": "scara",
            "states": self.states,
            "seed": self.seed,
            "tolerance": TOLERANCE,
            "agrees": self.agrees,
            "terms": [a.__dict__ for a in self.agreements],
        }


def scara_model_study(states: int = 10_000, seed: int = 0) -> ScaraModelStudy:
    """Compare the closed form with Pinocchio over random states within Table 1 [Thesis].

    The power balance is q̇ᵀ(½ Ṁ q̇ − V) = 0, with Ṁ = Σ ∂M/∂qₖ q̇ₖ of the form's own M and V [W].

    Args:
        states: How many to draw.
        seed: Of the draw.
    """
    arm = load_robot("scara")
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (states, arm.n))
    v = rng.uniform(-SPEED, SPEED, (states, arm.n))
    M, G = arm.mass_matrix(q), arm.gravity(q)
    V = arm.nonlinear_effects(q, v) - G
    own, printed = scara.velocity_torques(q, v), scara.printed_velocity_torques(q, v)
    return ScaraModelStudy(
        states,
        seed,
        (
            Agreement(
                "M",
                "kg·m² or kg",
                _largest(scara.mass_matrix(q) - M),
                _largest(scara.printed_mass_matrix(q) - M),
            ),
            Agreement("V", "N·m", _largest(own - V), _largest(printed - V)),
            Agreement("G", "N", *[_largest(scara.gravity_torques(q) - G)] * 2),
            Agreement("power balance", "W", _largest(_power(q, v, own)), _largest(_power(q, v, printed))),
        ),
    )


def _power(q: Array, v: Array, V: Array) -> Array:
    """q̇ᵀ(½ Ṁ q̇ − V) [W], (N,): M depends on cos θ₂ alone, so Ṁ is that part with its derivative put in."""
    quarter = np.array([0.0, 0.5 * np.pi, 0.0, 0.0])
    straight = np.zeros_like(q)
    at_quarter = scara.mass_matrix(straight + quarter)
    of_cosine = scara.mass_matrix(straight) - at_quarter  # M = at_quarter + of_cosine · cos θ₂
    rate = -(np.sin(q[:, 1]) * v[:, 1])[:, None, None] * of_cosine
    return np.einsum("ni,nij,nj->n", 0.5 * v, rate, v) - np.einsum("ni,ni->n", v, V)


def _largest(difference: Array) -> float:
    return float(np.abs(difference).max())
