"""``cdia compare``: where a model fails, and what changed between logs."""

from __future__ import annotations

from typing import Annotated

import typer

from cdia_pin.cli.conditions import Conditions, parse_conditions, under
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
    changes: Annotated[
        bool,
        typer.Option(
            "--changes/--no-changes", help="Of several logs, say what changed from the first to each other."
        ),
    ] = True,
    condition: Conditions = None,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    check: Check = True,
    report: Report = None,
    json: Json = None,
) -> None:
    """Show where a model fails: joint, and region of position, speed, acceleration, load and time.

    Of several logs of one arm, show the error in each and what changed from the first to the others: a payload,
    friction that grew, drives that warmed up. Their motions may differ.
    """
    require_writable(report, json, inputs=[*logs, *([model] if model else [])])
    conditions = parse_conditions(condition, logs)
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import discovery
        from cdia_pin.logs.conditioning import Conditioning

        reading = Reading(gains, joint_map, convert, topic)
        read, checks = read_logs(logs, known.robot, reading, check=check, tell=tell)
        given = under(conditions, read, logs)
        tell("comparing", 0.1)
        settings = discovery.DiscoverySettings(conditioning=Conditioning(cutoff=cutoff))
        found = discovery.compare(known, given, conditioning=settings.conditioning)
        by_log = [discovery.compare(known, log, conditioning=settings.conditioning) for log in given]
        changed = discovery.changes_between(known, given, settings, tell) if changes else ()
    from cdia_pin.viewers import changes_table, comparison_table, errors_by_log, where_it_fails, write_report

    show_inputs(console, known, given)
    if len(by_log) > 1:
        console.print(errors_by_log(by_log))
    console.print(comparison_table(found))
    console.print(where_it_fails(found))
    for each in changed:
        console.print(changes_table(each))
    document = found.to_dict()
    if len(by_log) > 1:
        document["by_log"] = [c.to_dict() for c in by_log]
        document["changes"] = [c.to_dict() for c in changed]
    write_all(
        console,
        (json, lambda f: write_json(document, f)),
        (report, lambda f: write_report(f, found, checks=checks, command=ctx.obj)),
    )
