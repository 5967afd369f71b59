"""``cdia view``: an arm in the browser, its links coloured by the state of their joints."""

from __future__ import annotations

from typing import Annotated

import typer

from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading
from cdia_pin.cli.interrupts import until_interrupted
from cdia_pin.cli.monitor_options import MONITOR, Bank, Healthy
from cdia_pin.cli.options import (
    AtMostOneLog,
    Check,
    Columns,
    Convert,
    Episode,
    Format,
    Gains,
    JointMap,
    Model,
    Robot,
    Topic,
    TorqueSide,
)
from cdia_pin.cli.ranges import PACE, PORT, RATE
from cdia_pin.cli.simulation_options import SIMULATION, Duration, Fault, Seed
from cdia_pin.extras import require

PAGE = "Page"


def view(
    log: AtMostOneLog = None,
    *,
    robot: Robot,
    model: Model = None,
    healthy: Healthy = None,
    monitored: Annotated[
        bool,
        typer.Option(
            "--monitor",
            help="Show the stages of a monitor instead of the residual of the model; the first part of LOG is taken as "
            "healthy.",
            rich_help_panel=MONITOR,
        ),
    ] = False,
    bank: Bank = None,
    simulate: Annotated[
        bool,
        typer.Option(
            "--simulate", help="Show a simulated closed loop instead of a log.", rich_help_panel=SIMULATION
        ),
    ] = False,
    fault: Fault = None,
    accommodate: Annotated[
        bool,
        typer.Option(
            "--accommodate/--no-accommodate",
            help="Let the monitor correct the control, or only watch.",
            rich_help_panel=SIMULATION,
        ),
    ] = True,
    duration: Duration = 30.0,
    rate: Annotated[
        float,
        typer.Option(
            "--rate",
            metavar="HZ",
            help="Ticks of the control per second \\[Hz].",
            rich_help_panel=SIMULATION,
            callback=RATE,
        ),
    ] = 1000.0,
    seed: Seed = 0,
    speed: Annotated[
        float,
        typer.Option(
            "--speed",
            metavar="FACTOR",
            help="Simulated seconds in a second; 0: as fast as they are computed.",
            callback=PACE,
            rich_help_panel=SIMULATION,
        ),
    ] = 1.0,
    port: Annotated[
        int,
        typer.Option(
            "--port",
            metavar="N",
            help="Port on this machine; 0: a free one.",
            rich_help_panel=PAGE,
            callback=PORT,
        ),
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in a browser.", rich_help_panel=PAGE)
    ] = True,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    torque_side: TorqueSide = None,
    check: Check = True,
) -> None:
    """Show an arm move in the browser: a log, or a simulation with faults while it is computed.

    Links are coloured by the residual of the model at their joint or, with --healthy, --monitor or --simulate, by the
    stage of a monitor; an arc shows the missing torque. Only this machine can reach the page, until Ctrl-C.
    """
    if simulate == (log is not None):
        raise CommandError("give either a LOG or --simulate" if log else "give a LOG, or --simulate")
    if log is not None and fault:
        raise CommandError("--fault needs a simulation: add --simulate and leave out the LOG")
    if simulate and (healthy or monitored):
        raise CommandError(
            "--healthy and --monitor need a LOG: --simulate has a monitor that learns by itself"
        )
    if simulate and (
        gains or joint_map or convert or format or columns or torque_side or episode is not None
    ):
        raise CommandError("options of reading need a LOG: leave them out with --simulate")
    if log is not None and bank and not (healthy or monitored):
        raise CommandError("--bank needs a monitor: add --healthy or --monitor")
    require("view", "live views")
    from cdia_pin.cli import view_sources
    from cdia_pin.cli.view_page import Page

    page = Page(port, browser)
    reading = Reading(gains, joint_map, convert, topic, format, columns, episode, torque_side=torque_side)
    with until_interrupted():
        if log is None:
            asked = view_sources.Simulation(
                tuple(fault or ()), accommodate, duration, rate, seed, speed, bank
            )
            view_sources.show_simulation(page, robot, model, asked)
        elif healthy or monitored:
            view_sources.show_monitored(page, robot, model, [log, *(healthy or [])], bank, reading, check)
        else:
            view_sources.show_compared(page, robot, model, log, reading, check)
