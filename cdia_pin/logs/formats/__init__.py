"""Formats of logs: which column holds which signal of which joint, and what the numbers are."""

from cdia_pin.logs.formats.choice import ColumnChoice, choose_columns
from cdia_pin.logs.formats.known import CSV, FORMATS, LEROBOT, ROS2, format_of, recognised
from cdia_pin.logs.formats.log_format import LogFormat, Recorded
from cdia_pin.logs.formats.patterns import column_patterns

__all__ = [
    "CSV",
    "FORMATS",
    "LEROBOT",
    "ROS2",
    "ColumnChoice",
    "LogFormat",
    "Recorded",
    "choose_columns",
    "column_patterns",
    "format_of",
    "recognised",
]
