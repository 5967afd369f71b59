"""Settings of a fleet: what is fitted in every log, and every number that decides, with its reason."""

from __future__ import annotations

from dataclasses import dataclass, replace

from cdia_pin.logs.conditioning import Conditioning
from cdia_pin.phrases import settings_repr
from cdia_pin.selection.discovery_settings import DiscoverySettings


@dataclass(frozen=True, repr=False)
class FleetFitSettings:
    """What is fitted in every log of a robot, and how.

    Attributes:
        job: Names of effects that change with the job, such as the payload. They are fitted in every log beside the
            others, and never count as wear.
        searched: Names of effects of one joint that the model lacks and that are looked for in every log, each alone
            beside all that is fitted: a drive that weakens, an encoder that slipped.
        cutoff: Cut-off of the filter [Hz]; chosen from each log if None.
        blocks: Contiguous blocks of time for intervals [1]. Twelve leave eleven degrees of freedom, and are still
            longer than a second in a log of half a minute.
        least_moving: Share of the time in which a joint must move for its parameters to be fitted [1]. A joint that
            moves less shows its friction at a few postures only.
    """

    job: tuple[str, ...] = ("payload",)
    searched: tuple[str, ...] = ("actuator_gain", "encoder_offset")
    cutoff: float | None = None
    blocks: int = 12
    least_moving: float = 0.2

    __repr__ = settings_repr

    @property
    def discovery(self) -> DiscoverySettings:
        """How logs are filtered, which samples count, and how a fit is repeated."""
        usual = DiscoverySettings()
        rest = replace(usual.rest, resting_share=1.0 - self.least_moving)
        return replace(usual, conditioning=Conditioning(cutoff=self.cutoff), rest=rest)
