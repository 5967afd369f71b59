"""``cdia compare``: where a model fails, and what changed between logs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.circumstances import (
    Contact,
    Environment,
    Mounted,
    Mounting,
    Surroundings,
    expected_effects,
)
from cdia_pin.cli.conditions import Conditions, parse_conditions
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.next_command import follow_checks, free, show_next, ways_of
from cdia_pin.cli.options import (
    OUTPUT,
    Check,
    Columns,
    Convert,
    Cutoff,
    Episode,
    Format,
    Gains,
    JointMap,
    Json,
    Logs,
    Model,
    Report,
    Robot,
    Topic,
    TorqueSide,
)
from cdia_pin.cli.outputs import require_report, require_writable, write_all, write_json

if TYPE_CHECKING:
    from cdia_pin.discovery import Comparison
    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import Log
    from cdia_pin.logs.conditioning import Conditioning


def compare(
    ctx: typer.Context,
    logs: Logs,
    *,
    robot: Robot,
    model: Model = None,
    changes: Annotated[
        bool,
        typer.Option(
            "--changes/--no-changes",
            help="With several logs, list what changed from the first to each other.",
        ),
    ] = True,
    everything: Annotated[
        bool,
        typer.Option(
            "--all",
            help="With several logs, show also in which regions the model fails in them.",
            rich_help_panel=OUTPUT,
        ),
    ] = False,
    environment: Environment = Surroundings.AIR,
    contact: Contact = False,
    mounted: Mounted = Mounting.UPRIGHT,
    condition: Conditions = None,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    torque_side: TorqueSide = None,
    check: Check = True,
    report: Report = None,
    json: Json = None,
) -> None:
    """Show where a model fails: joint, and region of position, speed, acceleration, load and time.

    With several logs of one arm, show what changed from the first to the others, and the error in each: a payload,
    friction that grew, drives that warmed up. Their motions may differ.
    """
    require_report(report)
    require_writable(report, json, inputs=[*logs, *([model] if model else [])])
    conditions = parse_conditions(condition, logs)
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin.changes import changes_between
        from cdia_pin.logs.conditioning import Conditioning
        from cdia_pin.selection import DiscoverySettings

        reading = Reading(
            gains,
            joint_map,
            convert,
            topic,
            format,
            columns,
            episode,
            conditions,
            torque_side,
            ways=ways_of(ctx),
        )
        given, checks = read_logs(logs, known.robot, reading, check=check, tell=tell, like=known)
        tell("comparing", 0.1)
        settings = DiscoverySettings(
            conditioning=Conditioning(cutoff=cutoff),
            expected=expected_effects(environment, contact, mounted),
        )
        found, by_log = _compared(known, given, settings.conditioning)
        changed = changes_between(known, given, settings, tell) if changes else ()
    from cdia_pin.viewers import changes_table, comparison_table, errors_by_log, where_it_fails, write_report

    show_inputs(console, known, given)
    for each in changed:
        console.print(changes_table(each))
    if by_log:
        console.print(errors_by_log(by_log))
    if everything or not changed:
        console.print(comparison_table(found))
        console.print(where_it_fails(found))
    else:
        console.print("--all shows where the model fails.", style="dim")
    document: dict[str, object] = {**found.to_dict()}
    if by_log:
        document["by_log"] = [c.to_dict() for c in by_log]
        document["changes"] = [c.to_dict() for c in changed]
    write_all(
        console,
        (json, lambda f: write_json(document, f)),
        (
            report,
            lambda f: write_report(f, found, checks=checks, changes=changed, by_log=by_log, command=ctx.obj),
        ),
    )
    show_next(console, follow_checks(ctx, checks, "discover", *logs, save=free("model.json")))


def _compared(
    known: Dynamics, logs: Sequence[Log], conditioning: Conditioning
) -> tuple[Comparison, list[Comparison]]:
    """Compare a model with all logs together and, where there are several, with each; filter each log once."""
    from cdia_pin.discovery import compare_in
    from cdia_pin.logs.conditioning import condition
    from cdia_pin.regression.experiment import Experiment

    robot = known.robot
    motions = [condition(log, robot, conditioning) for log in logs]
    together = compare_in(Experiment.of(robot, motions), known)
    each = [compare_in(Experiment.of(robot, [m]), known) for m in motions] if len(motions) > 1 else []
    return together, each
