"""Selection: which effects a model needs, by the evidence for each set of them."""

from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem

__all__ = ["DiscoverySettings", "Problem"]
