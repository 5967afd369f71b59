"""Studies and campaigns: many runs, or one closed loop in detail; their results are numbers."""

from cdia_pin.campaigns.campaign import run_campaign
from cdia_pin.campaigns.campaign_result import CampaignResult, Cell, OperatingPoint
from cdia_pin.campaigns.campaign_spec import CampaignError, CampaignSpec, FaultCase, plan_text, read_spec
from cdia_pin.campaigns.estimates import Estimate
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.run_store import RunStore
from cdia_pin.campaigns.tuning import tune
from cdia_pin.campaigns.tuning_result import TradeOff, TuningResult

__all__ = [
    "CampaignError",
    "CampaignResult",
    "CampaignSpec",
    "Cell",
    "Estimate",
    "FaultCase",
    "OperatingPoint",
    "RunRow",
    "RunStore",
    "TradeOff",
    "TuningResult",
    "plan_text",
    "read_spec",
    "run_campaign",
    "tune",
]
