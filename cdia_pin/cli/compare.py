"""``cdia compare``: where a model fails."""

from __future__ import annotations

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.options import (
    Check,
    Convert,
    Cutoff,
    Gains,
    JointMap,
    Json,
    Logs,
    Model,
    Report,
    Robot,
    Topic,
)
from cdia_pin.cli.outputs import require_writable, write_all, write_json


def compare(
    ctx: typer.Context,
    logs: Logs,
    *,
    robot: Robot,
    model: Model = None,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    check: Check = True,
    report: Report = None,
    json: Json = None,
) -> None:
    """Show where a model fails: joint, and region of position, speed, acceleration, load and time."""
    require_writable(report, json, inputs=[*logs, *([model] if model else [])])
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import discovery
        from cdia_pin.logs.conditioning import Conditioning

        reading = Reading(gains, joint_map, convert, topic)
        given, checks = read_logs(logs, known.robot, reading, check=check, tell=tell)
        tell("comparing", 0.5)
        found = discovery.compare(known, given, conditioning=Conditioning(cutoff=cutoff))
    from cdia_pin.viewers import comparison_table, where_it_fails, write_report

    show_inputs(console, known, given)
    console.print(comparison_table(found))
    console.print(where_it_fails(found))
    write_all(
        console,
        (json, lambda f: write_json(found.to_dict(), f)),
        (report, lambda f: write_report(f, found, checks=checks, command=ctx.obj)),
    )
