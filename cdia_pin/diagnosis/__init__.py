"""Change detection, isolation and accommodation while an arm moves, after the thesis and beyond it."""

from cdia_pin.diagnosis.bank import DEFAULT_BANK, Bank
from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.record import MonitorRun, Recorder, replay
from cdia_pin.diagnosis.status import Event, Stage, Status, Verdict

__all__ = [
    "DEFAULT_BANK",
    "Bank",
    "Event",
    "Monitor",
    "MonitorRun",
    "MonitorSettings",
    "Recorder",
    "Stage",
    "Status",
    "Verdict",
    "replay",
]
