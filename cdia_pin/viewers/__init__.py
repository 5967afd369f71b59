"""Viewers read results and compute nothing: tables for the terminal, a page for the browser."""

from cdia_pin.viewers.report import write_report
from cdia_pin.viewers.report_monitor import write_monitor_report
from cdia_pin.viewers.text import (
    addition_table,
    check_table,
    comparison_table,
    discovery_table,
    where_it_fails,
)
from cdia_pin.viewers.text_calibration import calibration_table
from cdia_pin.viewers.text_changes import changes_table, errors_by_log
from cdia_pin.viewers.text_identification import identification_table
from cdia_pin.viewers.text_monitor import events_table, joints_table, run_summary, tracking_table
from cdia_pin.viewers.verdict import verdict_sentences

__all__ = [
    "addition_table",
    "calibration_table",
    "changes_table",
    "check_table",
    "comparison_table",
    "discovery_table",
    "errors_by_log",
    "events_table",
    "identification_table",
    "joints_table",
    "run_summary",
    "tracking_table",
    "verdict_sentences",
    "where_it_fails",
    "write_monitor_report",
    "write_report",
]
