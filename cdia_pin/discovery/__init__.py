"""Discovery: where a model fails against logs, which effect it lacks, and what is left."""

from cdia_pin.discovery.change_result import Change, Changes
from cdia_pin.discovery.changes import what_changed
from cdia_pin.discovery.comparison import Comparison, compare, compare_in
from cdia_pin.discovery.conditions import changes_between
from cdia_pin.discovery.discovering import add_effect, add_effect_in, discover, discover_in
from cdia_pin.discovery.excitation import Excitation, ExcitationSettings, excite
from cdia_pin.discovery.identification import Identification, IdentificationSettings, identify
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.result import Confusion, Discovery, Ranked, Step
from cdia_pin.discovery.settings import DiscoverySettings

__all__ = [
    "Change",
    "Changes",
    "Comparison",
    "Confusion",
    "Discovery",
    "DiscoverySettings",
    "Excitation",
    "ExcitationSettings",
    "Identification",
    "IdentificationSettings",
    "Problem",
    "Ranked",
    "Step",
    "add_effect",
    "add_effect_in",
    "changes_between",
    "compare",
    "compare_in",
    "discover",
    "discover_in",
    "excite",
    "identify",
    "what_changed",
]
