"""Changes: the effects by which an arm differs between logs."""

from cdia_pin.changes.changes_result import Change, Changes
from cdia_pin.changes.conditions import changes_between
from cdia_pin.changes.detection import what_changed

__all__ = ["Change", "Changes", "changes_between", "what_changed"]
