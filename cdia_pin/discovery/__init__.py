"""Discovery: where a model differs from logs, which effects it lacks, and what remains unexplained."""

from cdia_pin.discovery.addition import add_effect, add_effect_in
from cdia_pin.discovery.comparison import Comparison, compare, compare_in
from cdia_pin.discovery.discovery_result import Discovery, Ranked, Step
from cdia_pin.discovery.missing_effects import discover, discover_in
from cdia_pin.discovery.verdict import DiscoveryVerdict

__all__ = [
    "Comparison",
    "Discovery",
    "DiscoveryVerdict",
    "Ranked",
    "Step",
    "add_effect",
    "add_effect_in",
    "compare",
    "compare_in",
    "discover",
    "discover_in",
]
