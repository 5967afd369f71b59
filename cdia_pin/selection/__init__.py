"""Selection: which effects a model needs. A criterion compares sets of effects."""

from cdia_pin.selection.criterion import SelectionCriterion
from cdia_pin.selection.discovery_settings import (
    AlternativeSettings,
    DiscoverySettings,
    EveryLinkSettings,
    MemorySettings,
)
from cdia_pin.selection.problem import Problem

__all__ = [
    "AlternativeSettings",
    "DiscoverySettings",
    "EveryLinkSettings",
    "MemorySettings",
    "Problem",
    "SelectionCriterion",
]
