"""``cdia simulate``: the log of an arm with faults."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import load_inputs, show_inputs
from cdia_pin.cli.monitor_options import DEFAULT_ENGINE, MONITOR, Bank, Engine
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json, Report, Robot
from cdia_pin.cli.outputs import require_report, require_writable, write_all, write_json
from cdia_pin.cli.ranges import MODEL_ERROR, SHARE
from cdia_pin.cli.ranges import RATE as RATES
from cdia_pin.cli.simulation_options import SIMULATION, Duration, Fault, Seed
from cdia_pin.version import __version__

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import Log

RATE, CONTROL_RATE = 250.0, 1000.0  # [Hz]
QUANTUM = 2e-5  # [rad or m], of the encoders of an arm with noise


def simulate(
    ctx: typer.Context,
    *,
    robot: Robot,
    out: Annotated[
        Path,
        typer.Option(
            "--out", "-o", metavar="LOG", show_default=False, help="Log to write: .csv, .parquet or .npz."
        ),
    ],
    fault: Fault = None,
    duration: Duration = 20.0,
    rate: Annotated[
        float | None,
        typer.Option(
            "--rate",
            metavar="HZ",
            show_default=False,
            help=f"Samples of the log per second \\[Hz]; {RATE:g}, or {CONTROL_RATE:g}, that of the control, "
            "with a monitor.",
            callback=RATES,
            rich_help_panel=SIMULATION,
        ),
    ] = None,
    noise: Annotated[
        float,
        typer.Option(
            "--noise",
            metavar="SHARE",
            help=f"Noise of the torques over their RMS, with encoder steps of {QUANTUM:g} rad; 0: no flaw.",
            callback=SHARE,
            rich_help_panel=SIMULATION,
        ),
    ] = 0.01,
    seed: Seed = 0,
    accommodate: Annotated[
        bool | None,
        typer.Option(
            "--accommodate/--no-accommodate",
            show_default=False,
            help="Add a monitor that corrects the control, or only watches; no monitor if left out.",
            rich_help_panel=MONITOR,
        ),
    ] = None,
    bank: Bank = None,
    engine: Engine = DEFAULT_ENGINE,
    model_error: Annotated[
        float,
        typer.Option(
            "--model-error",
            metavar="SHARE",
            help="Largest relative error of the inertias that the control knows, where a monitor runs; without "
            "any error, thresholds would be those of noise alone.",
            callback=MODEL_ERROR,
            rich_help_panel=MONITOR,
        ),
    ] = 0.03,
    report: Report = None,
    json: Json = None,
) -> None:
    """Simulate an arm with faults on an exciting motion, under computed torque that does not know them.

    With --accommodate a monitor learns from healthy runs on other motions, then monitors this one and corrects it.

    A fault may come and go: after, until, period (s), rate (1/s), duty, or q, dq, speed, tau=LOWER..UPPER.
    """
    import numpy as np

    from cdia_pin.dynamics import Dynamics
    from cdia_pin.dynamics.physical import require_physical
    from cdia_pin.dynamics.sensors import Sensors
    from cdia_pin.dynamics.simulate import require_steps
    from cdia_pin.dynamics.simulate import simulate as run
    from cdia_pin.dynamics.trajectories import exciting_trajectory
    from cdia_pin.effects import parse_term
    from cdia_pin.logs import write_log
    from cdia_pin.logs.log_writer import WRITABLE

    if out.suffix.lower() not in WRITABLE:
        raise CommandError(f"cannot write {out}: the suffix must be one of {', '.join(WRITABLE)}")
    require_report(report)
    require_writable(json, report, tables=[out])
    console = stdout(json)
    require_steps(
        duration, 1.0 / max(rate or 0.0, CONTROL_RATE)
    )  # before a motion is made, which takes long too
    arm = load_inputs(robot, None).robot
    plant = Dynamics(arm, tuple(parse_term(text) for text in fault or []))
    require_physical(plant.terms, arm)
    if accommodate is not None:
        from cdia_pin.campaigns.closed_loop import LoopSettings
        from cdia_pin.cli.simulate_loop import LoopRequest, simulate_loop

        settings = LoopSettings(CONTROL_RATE if rate is None else rate, noise, model_error, seed=seed)
        asked = LoopRequest(
            settings, duration, accommodate, engine, tuple(bank or ()), out, report, json, ctx.obj or ""
        )
        simulate_loop(console, plant, asked)
        show_next(console, command_line("monitor", out, "--robot", robot))
        return
    if bank or report:
        raise CommandError("--bank and --report need a monitor: add --accommodate or --no-accommodate")
    rate = RATE if rate is None else rate
    motion_source, noise_source = np.random.default_rng(seed).spawn(2)
    with progress() as tell:
        tell(f"simulating {duration:g} s", 0.0)
        motion = exciting_trajectory(plant.robot, motion_source, duration=duration)
        sensors = Sensors(effort_share=noise, position_quantum=QUANTUM if noise else 0.0)
        log = run(plant, motion, rate=rate, sensors=sensors, rng=noise_source)
    error = np.sqrt(np.mean((log.position - motion(log.time).q) ** 2, axis=0))
    tracking = dict(zip(plant.robot.joints, error.tolist(), strict=True))
    show_inputs(console, plant, [log], role="plant")
    _show(console, plant, log, tracking)
    document: dict[str, object] = {
        "schema": schemas.EVENTS,
        "robot": plant.robot.name,
        "joints": list(plant.robot.joints),
        "events": [],
        "tracking_rms": tracking,
        "plant": [t.to_dict(plant.robot) for t in plant.terms],
        "record": {
            "version": __version__,
            "duration": duration,
            "rate": rate,
            "noise": noise,
            "seed": seed,
            "log": str(out),
        },
    }
    write_all(console, (out, lambda f: write_log(log, f)), (json, lambda f: write_json(document, f)))
    show_next(console, command_line("discover", out, "--robot", robot))


def _show(console: Console, plant: Dynamics, log: Log, tracking: dict[str, float]) -> None:
    import numpy as np
    from rich.text import Text

    from cdia_pin.viewers.whole_table import WholeTable

    table = WholeTable()
    table.add_column("joint", style="bold")
    for heading in ("moves over", "fastest", "torque RMS", "tracking error RMS"):
        table.add_column(heading, justify="right")
    travel, fastest = (
        np.ptp(log.position, axis=0),
        np.abs(np.gradient(log.position, log.time, axis=0)).max(axis=0),
    )
    effort = np.sqrt(np.mean(log.effort**2, axis=0))
    for j, joint in enumerate(plant.robot.joints):
        x, f = ("m", "N") if plant.robot.is_prismatic[j] else ("rad", "N·m")
        values = ((travel[j], x), (fastest[j], f"{x}/s"), (effort[j], f), (tracking[joint], x))
        table.add_row(Text(joint), *(f"{value:.3g} {unit}" for value, unit in values))
    console.print(table)
