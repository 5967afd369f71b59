"""Settings of an identification."""

from __future__ import annotations

from dataclasses import dataclass, field

from cdia_pin.logs.conditioning import Conditioning
from cdia_pin.phrases import settings_repr


@dataclass(frozen=True, repr=False)
class IdentificationSettings:
    """How logs are filtered, and what may be fitted to them.

    Attributes:
        conditioning: How logs are filtered.
        strength: Strength of the prior on bodies around the URDF [1], see `urdf_precision`; chosen by cross-validation
            if None.
        refine: Use richer laws than Coulomb and viscous friction where they predict held-out blocks better.
        blocks: Number of blocks of time for cross-validation, held-out errors and intervals.
        least_gain: Share of a joint's mean squared error that a richer law must explain in unseen blocks [1], because
            laws that explain less change with the log.
        least_torque: RMS torque of a richer law over the joint's RMS torque [1], because less changes nothing that a
            user notices.
        least_motion: Share of the samples in which a joint must move to get friction and a rotor [1], because at rest
            friction is whatever holds the joint.
        least_rigid_share: Share of a joint's torque that the rigid body must have for laws of the load [1], because
            where all torque is friction, load and friction are not identifiable.
    """

    conditioning: Conditioning = field(default_factory=Conditioning)
    strength: float | None = None
    refine: bool = True
    blocks: int = 10
    least_gain: float = 0.03
    least_torque: float = 0.005
    least_motion: float = 0.1
    least_rigid_share: float = 0.2

    __repr__ = settings_repr
