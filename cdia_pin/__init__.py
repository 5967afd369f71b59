"""Find which physical effect a robot arm's model is missing, name it, add it, watch the error fall.

The public names are loaded when they are first used, so that ``import cdia_pin`` stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cdia_pin.display import show_with
from cdia_pin.version import __version__

if TYPE_CHECKING:
    from cdia_pin import effects
    from cdia_pin.changes import Changes, what_changed
    from cdia_pin.diagnosis import Monitor, MonitorSettings
    from cdia_pin.discovery import Comparison, Discovery, add_effect, compare, discover
    from cdia_pin.dynamics import Dynamics, load_model, save_model
    from cdia_pin.dynamics.simulate import simulate
    from cdia_pin.dynamics.trajectories import exciting_trajectory
    from cdia_pin.effects import Effect, Term
    from cdia_pin.errors import CdiaError
    from cdia_pin.excitation import Excitation, ExcitationSettings, excite
    from cdia_pin.identification import Identification, IdentificationSettings, identify
    from cdia_pin.logs import Log, check_log, read_log, write_log
    from cdia_pin.logs.conditioning import Conditioning
    from cdia_pin.robot import RobotModel, load_robot, write_corrected_urdf
    from cdia_pin.selection import DiscoverySettings
    from cdia_pin.viewers.arm_page import view

# Public name → where it lives.
_HOME = {
    "load_robot": "robot",
    "RobotModel": "robot",
    "write_corrected_urdf": "robot",
    "Effect": "effects",
    "Term": "effects",
    "Dynamics": "dynamics",
    "load_model": "dynamics",
    "save_model": "dynamics",
    "simulate": "dynamics.simulate",
    "exciting_trajectory": "dynamics.trajectories",
    "Log": "logs",
    "read_log": "logs",
    "write_log": "logs",
    "check_log": "logs",
    "Conditioning": "logs.conditioning",
    "Monitor": "diagnosis",
    "MonitorSettings": "diagnosis",
    "add_effect": "discovery",
    "compare": "discovery",
    "discover": "discovery",
    "what_changed": "changes",
    "Changes": "changes",
    "Comparison": "discovery",
    "Discovery": "discovery",
    "DiscoverySettings": "selection",
    "excite": "excitation",
    "Excitation": "excitation",
    "ExcitationSettings": "excitation",
    "identify": "identification",
    "Identification": "identification",
    "IdentificationSettings": "identification",
    "CdiaError": "errors",
    "view": "viewers.arm_page",
}

__all__ = [
    "CdiaError",
    "Changes",
    "Comparison",
    "Conditioning",
    "Discovery",
    "DiscoverySettings",
    "Dynamics",
    "Effect",
    "Excitation",
    "ExcitationSettings",
    "Identification",
    "IdentificationSettings",
    "Log",
    "Monitor",
    "MonitorSettings",
    "RobotModel",
    "Term",
    "__version__",
    "add_effect",
    "check_log",
    "compare",
    "discover",
    "effects",
    "excite",
    "exciting_trajectory",
    "identify",
    "load_model",
    "load_robot",
    "read_log",
    "save_model",
    "simulate",
    "view",
    "what_changed",
    "write_corrected_urdf",
    "write_log",
]

show_with(lambda result: import_module("cdia_pin.viewers.notebook").html_of(result))


def __getattr__(name: str) -> Any:
    """Load a public name from its home on first use."""
    if name == "effects":
        return import_module("cdia_pin.effects")
    if name not in _HOME:
        raise AttributeError(f"module 'cdia_pin' has no attribute '{name}'")
    value = getattr(import_module(f"cdia_pin.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
