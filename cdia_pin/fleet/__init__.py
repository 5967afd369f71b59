"""Fleets: what every log of every robot says about its model, kept, and what changes over the days."""

from cdia_pin.fleet.addition import FleetAddition, add_logs
from cdia_pin.fleet.fleet_map import FleetError, FleetMap
from cdia_pin.fleet.store import FleetStore

__all__ = ["FleetAddition", "FleetError", "FleetMap", "FleetStore", "add_logs"]
