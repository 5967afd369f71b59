"""What `tune` chose, and what was given up for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from cdia_pin import schemas
from cdia_pin.campaigns.campaign_spec import CampaignSpec
from cdia_pin.campaigns.estimates import Estimate
from cdia_pin.version import __version__


@dataclass(frozen=True)
class TradeOff:
    """A threshold that keeps a rate of false alarms, and how soon it finds the faults.

    Attributes:
        settings: Settings of the engine.
        alarms_per_hour: Rate of false alarms of the threshold [1/h].
        factor: Threshold over that of the monitor with its usual margins [1].
        extrapolated: Whether the rate is below one alarm in all of the time without a fault.
        hours: That time [h].
        detected: Share of the faults whose residual crosses the threshold [1].
        median_delay: Median time from the onset to the crossing [s]; infinite if fewer than half cross it.
        late_delay: What 90 % of these times stay below [s].
        time_to_detect: Mean of these times; a fault that is not detected counts with the rest of its run [s].
    """

    settings: Mapping[str, float | int]
    alarms_per_hour: float
    factor: float
    extrapolated: bool
    hours: float
    detected: Estimate
    median_delay: float
    late_delay: float
    time_to_detect: float

    def __repr__(self) -> str:
        return f"TradeOff({self.alarms_per_hour:g} /h, {self.factor:.3g} ×, {self.time_to_detect:.3g} s to detect)"

    def to_dict(self) -> dict[str, Any]:
        """Return the trade-off for JSON."""
        return {**vars(self), "settings": dict(self.settings), "detected": self.detected.to_dict()}


@dataclass(frozen=True)
class TuningResult:
    """Result of `tune`.

    Attributes:
        spec: The plan of the runs.
        false_alarms: Largest rate of false alarms [1/h], of both detectors together.
        settings: Fields of `MonitorSettings` that were chosen.
        best: The choice.
        options: Every filter and debounce at the stated rate.
        rates: The chosen filter and debounce at other rates, from rare to frequent.
        failed: Number of runs that could not be made.
    """

    spec: CampaignSpec
    false_alarms: float
    settings: Mapping[str, float | int]
    best: TradeOff
    options: tuple[TradeOff, ...]
    rates: tuple[TradeOff, ...]
    failed: int

    def __repr__(self) -> str:
        return f"TuningResult({self.false_alarms:g} false alarms an hour: {self.line()})"

    def line(self) -> str:
        """Return the line of Python that makes the settings."""
        return f"MonitorSettings({', '.join(f'{k}={v!r}' for k, v in self.settings.items())})"

    def confirmation(self, spec: CampaignSpec) -> CampaignSpec:
        """Return a plan that tries the chosen settings on arms that were not used for the choice.

        Args:
            spec: The plan for which the settings were chosen.
        """
        chosen = {name: (value,) for name, value in self.settings.items()}
        settings = tuple(sorted({**dict(spec.settings), **chosen}.items()))
        return replace(spec, seed=spec.seed + 1, settings=settings)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``cdia tune --json`` writes it."""
        return {
            "schema": schemas.TUNING,
            "false_alarms_per_hour": self.false_alarms,
            "settings": dict(self.settings),
            "best": self.best.to_dict(),
            "options": [o.to_dict() for o in self.options],
            "rates": [o.to_dict() for o in self.rates],
            "failed": self.failed,
            "spec": asdict(self.spec),
            "record": {"version": __version__, "campaign": self.spec.digest},
        }
