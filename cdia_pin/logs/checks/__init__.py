"""Checks of a log: what it holds, in which units, signs and order, and what it can tell."""

from cdia_pin.logs.checks.check import check_log
from cdia_pin.logs.checks.finding import Finding, LogCheck

__all__ = ["Finding", "LogCheck", "check_log"]
