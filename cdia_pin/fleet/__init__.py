"""Fleets: what every log of every robot says about its model, kept, and what changes over the days."""

from cdia_pin.fleet.addition import FleetAddition, add_logs
from cdia_pin.fleet.course import Course, RobotCourses
from cdia_pin.fleet.course_trend import Alarm, CourseTrend, Regressor
from cdia_pin.fleet.fleet_map import FleetError, FleetMap, FleetRobot
from cdia_pin.fleet.fleet_settings import FleetFitSettings
from cdia_pin.fleet.prometheus import prometheus_text
from cdia_pin.fleet.store import FleetStore
from cdia_pin.fleet.trend import FleetChange, FleetTrend, RobotTrend, TrendSettings, fleet_trend
from cdia_pin.fleet.trend_documents import trend_document

__all__ = [
    "Alarm",
    "Course",
    "CourseTrend",
    "FleetAddition",
    "FleetChange",
    "FleetError",
    "FleetFitSettings",
    "FleetMap",
    "FleetRobot",
    "FleetStore",
    "FleetTrend",
    "Regressor",
    "RobotCourses",
    "RobotTrend",
    "TrendSettings",
    "add_logs",
    "fleet_trend",
    "prometheus_text",
    "trend_document",
]
