"""``cdia simulate --accommodate``: a closed loop with a monitor in it, beside the same motion without."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.cli.console import progress
from cdia_pin.cli.inputs import show_inputs
from cdia_pin.cli.monitor import show_run
from cdia_pin.cli.outputs import write_all, write_json

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.campaigns.closed_loop import LoopSettings
    from cdia_pin.dynamics import Dynamics


@dataclass(frozen=True)
class LoopRequest:
    """The options of a closed loop.

    Attributes:
        settings: Of the loop.
        duration: Length of the motion [s].
        accommodate: Whether the monitor corrects the control, or only watches.
        engine: Of the monitor.
        bank: Known effects; the usual ones if empty.
        out: Log of the monitored run.
        report: HTML report.
        json: Result as JSON.
        command: The command as typed.
    """

    settings: LoopSettings
    duration: float
    accommodate: bool
    engine: str
    bank: tuple[str, ...]
    out: Path
    report: Path | None
    json: str | None
    command: str


def simulate_loop(console: Console, plant: Dynamics, asked: LoopRequest) -> None:
    """Run a motion healthy, faulty and with a monitor, and show the comparison.

    Args:
        console: Where the result is shown.
        plant: The arm; its terms are the faults, which control and monitor do not know.
        asked: The options.
    """
    from cdia_pin.campaigns.closed_loop import ClosedLoop
    from cdia_pin.campaigns.loop_comparison import compare_loops
    from cdia_pin.diagnosis import DEFAULT_BANK, Bank
    from cdia_pin.diagnosis.engines import settings_of
    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import write_log
    from cdia_pin.viewers import tracking_table, write_monitor_report

    settings = settings_of(asked.engine, accommodate=asked.accommodate)
    bank = Bank.of(plant.robot, asked.bank or DEFAULT_BANK)
    loop = ClosedLoop(Dynamics(plant.robot), asked.settings)
    loop.motion(0, asked.duration)  # what is impossible is told before the healthy runs
    with progress() as tell:
        monitor = loop.monitor(
            bank=bank,
            engine=asked.engine,
            settings=settings,
            progress=lambda said, share: tell(said, 0.3 * share),
        )
        found = compare_loops(
            loop,
            monitor,
            plant.terms,
            asked.duration,
            progress=lambda said, share: tell(said, 0.3 + 0.7 * share),
        )
    run = found.monitored.monitored
    assert run is not None
    show_inputs(console, plant, [found.monitored.log], role="plant")
    for sentence in run.record["notes"]:
        console.print(sentence, style="dim", markup=False)
    show_run(console, run)
    console.print(tracking_table(plant.robot, found.tracking(), found.since))
    joints = plant.robot.joints
    tracking = {name: dict(zip(joints, rms.tolist(), strict=True)) for name, rms in found.tracking().items()}
    document = {
        **run.to_dict(),
        "tracking_rms": tracking.get("accommodated", tracking["faulty"]),
        "tracking": {"since": found.since, **tracking},
        "plant": [t.to_dict(plant.robot) for t in plant.terms],
        "record": {**run.record, "duration": asked.duration, "log": str(asked.out)},
    }
    write_all(
        console,
        (asked.out, lambda f: write_log(found.monitored.log, f)),
        (asked.json, lambda f: write_json(document, f)),
        (
            asked.report,
            lambda f: write_monitor_report(
                f,
                run,
                tracking=found.tracking(),
                since=found.since,
                present=plant.terms,
                command=asked.command,
            ),
        ),
    )
