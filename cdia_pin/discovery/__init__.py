"""Discovery: where a model fails against logs, which effect it lacks, and what is left."""

from cdia_pin.discovery.comparison import Comparison, compare, compare_in
from cdia_pin.discovery.discovering import add_effect, add_effect_in, discover, discover_in
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.result import Confusion, Discovery, Ranked, Step
from cdia_pin.discovery.settings import DiscoverySettings

__all__ = [
    "Comparison",
    "Confusion",
    "Discovery",
    "DiscoverySettings",
    "Problem",
    "Ranked",
    "Step",
    "add_effect",
    "add_effect_in",
    "compare",
    "compare_in",
    "discover",
    "discover_in",
]
