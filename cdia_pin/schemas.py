"""Names of the JSON documents that the package writes, each with its version."""

from __future__ import annotations

from typing import Final

CALIBRATION: Final = "cdia-calibration/1"
CHANGES: Final = "cdia-changes/1"
CHECK: Final = "cdia-check/1"
COMPARISON: Final = "cdia-comparison/1"
CONVERSION: Final = "cdia-conversion/1"
DISCOVERY: Final = "cdia-discovery/1"
EFFECTS: Final = "cdia-effects/1"
EVENT_LOG: Final = "cdia-event-log/1"
EVENTS: Final = "cdia-events/1"
EXCITATION: Final = "cdia-excitation/1"
EXPORT: Final = "cdia-export/2"
IDENTIFICATION: Final = "cdia-identification/1"
MODEL: Final = "cdia-model/1"
MONITOR: Final = "cdia-monitor/1"
MONITOR_REPORT: Final = "cdia-monitor-report/1"
RANGES: Final = "cdia-ranges/1"
REPORT: Final = "cdia-report/1"
ROBOTS: Final = "cdia-robots/1"
SCENE: Final = "cdia-scene/1"
STUDY_ARMS: Final = "cdia-study-arms/1"
STUDY_SCARA_MODEL: Final = "cdia-study-scara-model/1"
STUDY_THESIS: Final = "cdia-study-thesis/1"
