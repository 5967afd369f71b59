"""Measured logs: reading, writing, checks, derivatives and conditioning."""

from cdia_pin.logs.checks import Finding, LogCheck, Severity, Topic, check_log
from cdia_pin.logs.conversion import Conversion
from cdia_pin.logs.log import Log
from cdia_pin.logs.log_reader import read_log
from cdia_pin.logs.log_writer import write_log

__all__ = [
    "Conversion",
    "Finding",
    "Log",
    "LogCheck",
    "Severity",
    "Topic",
    "check_log",
    "read_log",
    "write_log",
]
