"""The sources of ``cdia view``: a log with the model's residual, a log with a monitor, or a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.cli.console import progress
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs
from cdia_pin.cli.view_page import Pace, Page

if TYPE_CHECKING:
    from cdia_pin.diagnosis import Status


REACHED = 40  # positions from which the camera learns how far the arm reaches


@dataclass(frozen=True)
class Simulation:
    """The options of a simulation; each field is the option of that name."""

    faults: tuple[str, ...]
    accommodate: bool
    duration: float
    rate: float
    seed: int
    speed: float
    bank: Sequence[str] | None


def show_compared(
    page: Page, robot: str, model: Path | None, log: Path, reading: Reading, check: bool
) -> None:
    """Show a log, coloured by the residual of the model.

    Args:
        page: Where.
        robot: Name of the catalogue, or path of a URDF.
        model: File of a saved model; None for the URDF alone.
        log: The log.
        reading: How to read it.
        check: Whether to check it.
    """
    from cdia_pin.discovery import compare
    from cdia_pin.viewers.scene import Scene, timeline_of_comparison

    known = load_inputs(robot, model)
    with progress() as tell:
        given, _ = read_logs([log], known.robot, reading, check=check, tell=tell, like=known)
        tell("comparing", 0.4)
        timeline = timeline_of_comparison(compare(known, given))
        tell("drawing the arm", 0.8)
        scene = Scene.of(known.robot)
    with page.of(
        scene, timeline=timeline, position=timeline.position[0], title=f"{known.robot.name}, {log.name}"
    ):
        pass


def show_monitored(
    page: Page,
    robot: str,
    model: Path | None,
    logs: Sequence[Path],
    bank: Sequence[str] | None,
    reading: Reading,
    check: bool,
) -> None:
    """Show the first log as a monitor would have seen it live; the other logs are healthy runs.

    Args:
        page: Where.
        robot: Name of the catalogue, or path of a URDF.
        model: File of a saved model; None for the URDF alone.
        logs: The log to monitor, then healthy runs.
        bank: Known effects; the usual ones if None.
        reading: How to read the logs.
        check: Whether to check them.
    """
    from cdia_pin.diagnosis import Monitor
    from cdia_pin.diagnosis.healthy_part import alike, parted
    from cdia_pin.diagnosis.monitor_record import what_is_blind
    from cdia_pin.viewers.live import FrameMaker
    from cdia_pin.viewers.scene import Scene, monitor_stages

    known = load_inputs(robot, model)
    with progress() as tell:
        (watched, *runs), _ = read_logs(logs, known.robot, reading, check=check, tell=tell, like=known)
        if not runs:
            first, watched = parted(watched, None)
            runs = [first]
        watched, *runs = alike([watched, *runs], True, [])
        tell("learning from the healthy runs", 0.2)
        position_only = watched.velocity is None
        monitor = Monitor(
            known,
            healthy=runs,
            rate=watched.rate,
            position_only=position_only,
            bank=bank,
        )
        tell("drawing the arm", 0.8)
        scene = Scene.of(known.robot)
    title = f"{known.robot.name}, {logs[0].name}"
    reach = watched.position[:: max(1, len(watched.position) // REACHED)]
    with page.of(
        scene, stages=monitor_stages(), follow=False, position=watched.position[0], reach=reach, title=title
    ) as live:
        live.say(what_is_blind(monitor.record))
        frame_of = FrameMaker(known.robot)
        positions = iter(watched.position)

        def watch(status: Status) -> None:
            if frame := frame_of(status.time, next(positions), status):
                live.show(frame)

        monitor.replay(watched, watch)


def show_simulation(page: Page, robot: str, model: Path | None, asked: Simulation) -> None:
    """Show a closed loop with faults while it is computed.

    Args:
        page: Where.
        robot: Name of the catalogue, or path of a URDF.
        model: File of a saved model; None for the URDF alone.
        asked: The options.
    """
    import numpy as np

    from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
    from cdia_pin.diagnosis import DEFAULT_BANK, Bank, MonitorSettings
    from cdia_pin.diagnosis.monitor_record import what_is_blind
    from cdia_pin.dynamics import Dynamics
    from cdia_pin.dynamics.physical import require_physical
    from cdia_pin.effects import parse_term
    from cdia_pin.viewers.live import FrameMaker
    from cdia_pin.viewers.scene import Scene, monitor_stages

    known = load_inputs(robot, model)
    faults = Dynamics(known.robot, tuple(parse_term(text) for text in asked.faults)).terms
    require_physical(faults, known.robot, known.terms)
    bank = Bank.of(known.robot, asked.bank or DEFAULT_BANK)
    loop = ClosedLoop(known, LoopSettings(asked.rate, seed=asked.seed))
    motion = loop.motion(0, asked.duration)
    title = f"{known.robot.name}, simulated"
    reach = motion(np.linspace(0.0, asked.duration, REACHED)).q
    scene = Scene.of(known.robot)
    with page.of(scene, stages=monitor_stages(), position=reach[0], reach=reach, title=title) as live:

        def tell(sentence: str, share: float) -> None:
            live.say(f"Before it moves: {sentence}")

        monitor = loop.monitor(
            bank=bank, settings=MonitorSettings(accommodate=asked.accommodate), progress=tell
        )
        live.say(what_is_blind(monitor.record))
        frame_of, wait = FrameMaker(known.robot), Pace(asked.speed)
        count = int(asked.duration * loop.settings.rate)
        for tick in islice(loop.ticks(motion, faults, monitor), count):
            if frame := frame_of(tick.time, tick.q, tick.status, tick.desired):
                wait(tick.time)
                live.show(frame)
