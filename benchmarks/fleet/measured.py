"""The measured logs of one UR10e as a fleet of one."""

from __future__ import annotations

from pathlib import Path

from cdia_pin.fleet import FleetMap, FleetStore, FleetTrend, add_logs, fleet_trend
from cdia_pin.whole_files import write_whole

ARM = "ur10e"


def fleet_of_one(data: Path, folder: Path) -> FleetTrend:
    """Return the trend of the measured UR10e.

    Args:
        data: Folder of the measured logs.
        folder: Where map and store are kept.
    """
    logs = data / ARM
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "fleet.toml"
    write_whole(
        path,
        f'[robots.{ARM}]\nrobot = "{logs / "ur10e.urdf"}"\ngains = "{logs / "drive_gains.json"}"\n'
        f'logs = ["{logs}/*.csv"]\n',
    )
    store = FleetStore.at(folder / "store", make=True)
    add_logs(store, FleetMap.read(path))
    return fleet_trend(store)
