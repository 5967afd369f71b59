"""Selection: which effects a model needs. A criterion compares sets of effects."""

from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem

__all__ = ["DiscoverySettings", "Problem"]
