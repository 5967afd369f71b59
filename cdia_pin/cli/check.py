"""``cdia check``: what a log holds, and whether it can be used."""

from __future__ import annotations

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.next_command import follow_checks, show_next, ways_of
from cdia_pin.cli.options import (
    Columns,
    Convert,
    Episode,
    Format,
    Gains,
    JointMap,
    Json,
    OneLog,
    Robot,
    Topic,
    TorqueSide,
)
from cdia_pin.cli.outputs import require_writable, write_json


def check(
    ctx: typer.Context,
    log: OneLog,
    *,
    robot: Robot,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    torque_side: TorqueSide = None,
    json: Json = None,
) -> None:
    """Check a log against a robot: rate, gaps, units, sign, joint order, effort kind, saturation, excitation.

    Every finding is a sentence with its numbers and advice.
    """
    require_writable(json, inputs=[log])
    console = stdout(json)
    model = load_inputs(robot, None)
    with progress() as tell:
        from cdia_pin.logs import check_log

        reading = Reading(
            gains,
            joint_map,
            convert,
            topic,
            format,
            columns,
            episode,
            torque_side=torque_side,
            ways=ways_of(ctx),
        )
        logs, _ = read_logs([log], model.robot, reading, check=False, tell=tell)
        tell(f"checking {log.name}", 0.3)
        found = check_log(logs[0], model.robot)
    from cdia_pin.viewers import check_table

    show_inputs(console, model, logs, notes=False)
    console.print(check_table(found))
    if json:
        write_json(found.to_dict(), json)
    show_next(console, follow_checks(ctx, [found], "compare", log))
