"""Discovery: where a model fails against logs, which effect it lacks, and what is left."""

from cdia_pin.discovery.comparison import Comparison, compare
from cdia_pin.discovery.discovering import add_effect, discover
from cdia_pin.discovery.result import Confusion, Discovery, Ranked, Step
from cdia_pin.discovery.settings import DiscoverySettings

__all__ = [
    "Comparison",
    "Confusion",
    "Discovery",
    "DiscoverySettings",
    "Ranked",
    "Step",
    "add_effect",
    "compare",
    "discover",
]
