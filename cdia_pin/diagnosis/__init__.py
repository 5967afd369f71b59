"""Change detection, isolation and accommodation (CDIA) while an arm moves, after [Thesis] and beyond it."""

from cdia_pin.diagnosis.bank import DEFAULT_BANK, Bank
from cdia_pin.diagnosis.lasting_changes import LastingChanges, lasting_changes
from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.record import MonitorRun, Recorder, replay
from cdia_pin.diagnosis.sensor_fault import SensorCondition, SensorFault, SensorSignal
from cdia_pin.diagnosis.status import Event, EventStage, Stage, Status, Verdict

__all__ = [
    "DEFAULT_BANK",
    "Bank",
    "Event",
    "EventStage",
    "LastingChanges",
    "Monitor",
    "MonitorRun",
    "MonitorSettings",
    "Recorder",
    "SensorCondition",
    "SensorFault",
    "SensorSignal",
    "Stage",
    "Status",
    "Verdict",
    "lasting_changes",
    "replay",
]
