"""Checks of a log: its signals, units, signs and order, and what can be identified from it."""

from cdia_pin.logs.checks.check import check_log
from cdia_pin.logs.checks.finding import Finding, LogCheck, Severity, Topic

__all__ = ["Finding", "LogCheck", "Severity", "Topic", "check_log"]
