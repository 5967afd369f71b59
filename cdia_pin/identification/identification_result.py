"""The result of an identification: a model, its errors before and after, and its base parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.effects.body import Body
from cdia_pin.identification.base import BaseParameters
from cdia_pin.identification.identification_documents import IdentificationJson, IdentificationRecord
from cdia_pin.phrases import shortened
from cdia_pin.regression.shares import mean_share
from cdia_pin.robot.inertia import physical_margin

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Identification:
    """The outcome of `identify`; arrays have shape (n,).

    Attributes:
        model: The robot with all terms that were fitted, with intervals.
        torque_rms: RMS of the measured torque in the fitted logs [N·m or N].
        rms_before: RMS residual of the model as given, in the fitted logs [N·m or N].
        rms_after: RMS residual of the identified model, in the fitted logs [N·m or N].
        heldout_torque_rms: RMS of the measured torque in the held-out data [N·m or N].
        heldout_before: RMS residual of the model as given, in the held-out data [N·m or N].
        heldout_after: RMS residual of the identified model, in the held-out data [N·m or N].
        base: Base parameters.
        strength: Strength of the prior on bodies around the URDF [1].
        refined: Labels of the terms of richer friction laws.
        record: Logs, hashes, settings and version, enough to run the identification again.
    """

    model: Dynamics
    torque_rms: Array
    rms_before: Array
    rms_after: Array
    heldout_torque_rms: Array
    heldout_before: Array
    heldout_after: Array
    base: BaseParameters
    strength: float
    refined: tuple[str, ...]
    record: IdentificationRecord

    def __repr__(self) -> str:
        errors = (
            100 * mean_share(e, self.heldout_torque_rms) for e in (self.heldout_before, self.heldout_after)
        )
        error = " → ".join(f"{e:.3g} %" for e in errors)
        robot = shortened(self.model.robot.name)
        return f"Identification({robot}, {len(self.model.terms)} terms; held-out error {error})"

    @property
    def bodies(self) -> tuple[Term, ...]:
        """Terms of rigid bodies."""
        return tuple(t for t in self.model.terms if isinstance(t.effect, Body))

    @property
    def inertial_parameters(self) -> Array:
        """Total inertial parameters of each link, about its joint's frame, shape (n, 10)."""
        robot = self.model.robot
        out = robot.inertial_parameters.copy()
        for term in self.bodies:
            out += term.effect.on_links(np.array(term.theta), robot)
        return out

    @property
    def margin(self) -> Array:
        """Distance of each link from a body that cannot exist, see `physical_margin`, shape (n,)."""
        return np.array([physical_margin(p) for p in self.inertial_parameters])

    def to_dict(self) -> IdentificationJson:
        """Return the JSON of schema ``cdia-identification/1``."""
        robot = self.model.robot
        b = self.base
        rows = zip(b.names, b.units, b.grouped, b.urdf, b.value, b.half_width, b.identifiable, strict=True)
        return {
            "schema": schemas.IDENTIFICATION,
            "robot": robot.name,
            "joints": list(robot.joints),
            "torque_rms": robot.by_joint(self.torque_rms),
            "rms": {"before": robot.by_joint(self.rms_before), "after": robot.by_joint(self.rms_after)},
            "heldout_torque_rms": robot.by_joint(self.heldout_torque_rms),
            "heldout_rms": {
                "before": robot.by_joint(self.heldout_before),
                "after": robot.by_joint(self.heldout_after),
            },
            "terms": [t.to_dict(robot) for t in self.model.terms],
            "refined": list(self.refined),
            "inertial_parameters": dict(zip(robot.joints, self.inertial_parameters.tolist(), strict=True)),
            "physical_margin": robot.by_joint(self.margin),
            "base_parameters": [
                {
                    "name": name,
                    "unit": unit,
                    "grouped": int(grouped),
                    "urdf": float(urdf),
                    "value": float(value),
                    "ci95": [float(value - half), float(value + half)],
                    "told": bool(identifiable),
                }
                for name, unit, grouped, urdf, value, half, identifiable in rows
            ],
            "strength": self.strength,
            "record": self.record,
        }
