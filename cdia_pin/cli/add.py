"""``cdia add``: add one effect and see the error fall."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.conditions import Conditions, PerLog, parse_conditions, parse_per_log
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.discovery_files import DiscoveryFiles
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, require_unseen, show_inputs
from cdia_pin.cli.next_command import compare_saved, show_next, ways_of
from cdia_pin.cli.options import (
    Check,
    Columns,
    Convert,
    Cutoff,
    Episode,
    Format,
    Gains,
    Holdout,
    JointMap,
    Json,
    Logs,
    Model,
    Report,
    Robot,
    Save,
    Topic,
    TorqueSide,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery
    from cdia_pin.dynamics import Dynamics


def add(
    ctx: typer.Context,
    effect: Annotated[
        str,
        typer.Argument(
            metavar="EFFECT[@JOINT]",
            show_default=False,
            help="What to add (see cdia effects), or an expression such as 'sin(3*q)*dq@elbow_joint'.",
        ),
    ],
    logs: Logs,
    *,
    robot: Robot,
    model: Model = None,
    holdout: Holdout = None,
    save: Save = None,
    condition: Conditions = None,
    per_log: PerLog = None,
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
    """Add one effect to a model, fitted to the logs, and show the error before and after.

    The terms of the model are fitted again together with it. A term that the effect contains gives way to it.
    """
    unseen = holdout or []
    files = DiscoveryFiles(save, json, report)
    files.require_writable([*logs, *unseen])
    require_unseen(unseen, logs)
    conditions = parse_conditions(condition, [*logs, *unseen])
    if Path(effect).is_file():
        raise CommandError(f"'{effect}' is a file: the effect comes before the logs, cdia add EFFECT LOG...")
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import discovery
        from cdia_pin.effects import parse_effect
        from cdia_pin.logs.conditioning import Conditioning
        from cdia_pin.selection import DiscoverySettings

        added = parse_effect(effect, known.robot)
        settings = DiscoverySettings(
            conditioning=Conditioning(cutoff=cutoff),
            per_log=parse_per_log(per_log, logs, conditions, known.robot),
        )
        reading = Reading(
            gains,
            joint_map,
            convert,
            topic,
            format,
            columns,
            episode,
            conditions=conditions,
            torque_side=torque_side,
            ways=ways_of(ctx),
        )
        given, checks = read_logs(logs, known.robot, reading, check=check, tell=tell, like=known)
        held_out, _ = read_logs(unseen, known.robot, reading, check=check, tell=tell, like=known)
        found = discovery.add_effect(
            known, added, given, holdout=held_out or None, settings=settings, progress=tell
        )
    from cdia_pin.viewers import addition_table

    base = _without_replaced(known, added.label, found)
    show_inputs(console, base, given, held_out)
    for term in known.terms:
        if term.label == added.label:
            console.print(f"The model has {term.label} already: it is left out, and fitted again.\n")
        elif term not in base.terms:
            console.print(f"{term.label} is left out of the model: {added.label} contains it.\n")
    console.print(addition_table(found))
    files.write(
        console, found, base, given, conditioning=settings.conditioning, checks=checks, command=ctx.obj
    )
    show_next(console, compare_saved(ctx, logs, save))


def _without_replaced(known: Dynamics, label: str, found: Discovery) -> Dynamics:
    """Return the model before the addition, without the terms that the effect replaces."""
    kept = {t.label for t in found.model.terms} - {label}
    return replace(known, terms=tuple(t for t in known.terms if t.label in kept))
