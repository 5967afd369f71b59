"""Discovery: where a model fails against logs, which effect it lacks, and what is left."""

from cdia_pin.discovery.comparison import Comparison, compare
from cdia_pin.discovery.discovering import discover
from cdia_pin.discovery.result import Confusion, Discovery, Step
from cdia_pin.discovery.settings import DiscoverySettings

__all__ = ["Comparison", "Confusion", "Discovery", "DiscoverySettings", "Step", "compare", "discover"]
