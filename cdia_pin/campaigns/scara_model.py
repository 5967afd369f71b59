"""Comparison of the SCARA arm's URDF with the thesis' dynamics in closed form, corrected and as printed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.robot import load_robot, scara

Array = NDArray[np.float64]

TOLERANCE = 1e-11  # [unit of each term], between the corrected form and Pinocchio: rounding errors only
SPEED = np.pi * np.array([10 / 3, 5, 55 / 3, 1.2 / np.pi])  # [rad/s, rad/s, rad/s, m/s], limits of Table 1


class AgreementRecord(TypedDict):
    """An agreement in JSON; keys as the attributes of `Agreement`."""

    term: str
    unit: str
    corrected: float
    printed: float


class ScaraModelRecord(TypedDict):
    """The study in JSON, schema ``cdia-study-scara-model/1``; keys as the attributes of `ScaraModelStudy`."""

    schema: str
    robot: str
    states: int
    seed: int
    tolerance: float
    agrees: bool
    terms: list[AgreementRecord]


@dataclass(frozen=True)
class Agreement:
    """Difference of one term of the dynamics from Pinocchio's on the URDF.

    Attributes:
        term: Name of the term.
        unit: Unit of the differences.
        corrected: Largest difference of the corrected closed form.
        printed: Largest difference of the form as the thesis prints it.
    """

    term: str
    unit: str
    corrected: float
    printed: float

    def to_dict(self) -> AgreementRecord:
        """Return the agreement for JSON."""
        return {"term": self.term, "unit": self.unit, "corrected": self.corrected, "printed": self.printed}


@dataclass(frozen=True, repr=False)
class ScaraModelStudy:
    """Result of `scara_model_study`.

    Attributes:
        states: Number of random states.
        seed: Seed of the states.
        agreements: M, V, G, then the power balance.
    """

    states: int
    seed: int
    agreements: tuple[Agreement, ...]

    def __repr__(self) -> str:
        return f"ScaraModelStudy({self.states} states, seed {self.seed}, agrees={self.agrees})"

    @property
    def agrees(self) -> bool:
        """True if M, V and G of the corrected closed form are those of the URDF."""
        return all(a.corrected <= TOLERANCE for a in self.agreements[:3])

    def to_dict(self) -> ScaraModelRecord:
        """Return the result as ``cdia study scara-model --json`` writes it."""
        return {
            "schema": schemas.STUDY_SCARA_MODEL,
            "robot": "scara",
            "states": self.states,
            "seed": self.seed,
            "tolerance": TOLERANCE,
            "agrees": self.agrees,
            "terms": [a.to_dict() for a in self.agreements],
        }


def scara_model_study(states: int = 10_000, seed: int = 0) -> ScaraModelStudy:
    """Compare the closed form with Pinocchio over random states within Table 1 [Thesis].

    The power balance is q̇ᵀ(½ Ṁ q̇ − V) = 0, with Ṁ = Σ ∂M/∂qₖ q̇ₖ of the form's own M and V [W].

    Args:
        states: Number of random states.
        seed: Seed of the states.

    Returns:
        Largest differences of each term.
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
    """Compute q̇ᵀ(½ Ṁ q̇ − V) [W], shape (N,); M is linear in cos θ₂, so Ṁ is its slope times d(cos θ₂)/dt."""
    quarter = np.array([0.0, 0.5 * np.pi, 0.0, 0.0])
    straight = np.zeros_like(q)
    at_quarter = scara.mass_matrix(straight + quarter)
    of_cosine = scara.mass_matrix(straight) - at_quarter  # M = at_quarter + of_cosine · cos θ₂
    rate = -(np.sin(q[:, 1]) * v[:, 1])[:, None, None] * of_cosine
    return np.asarray(np.einsum("ni,nij,nj->n", 0.5 * v, rate, v) - np.einsum("ni,ni->n", v, V))


def _largest(difference: Array) -> float:
    return float(np.abs(difference).max())
