"""``cdia discover``: which physical effects a model lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.console import progress, say_written, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.options import (
    Check,
    Convert,
    Cutoff,
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
)
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.showing import show_discovery

if TYPE_CHECKING:
    from cdia_pin.effects import Effect
    from cdia_pin.robot import RobotModel

SEARCH = "Search"


def discover(
    ctx: typer.Context,
    logs: Logs,
    robot: Robot,
    model: Model = None,
    holdout: Holdout = None,
    save: Save = None,
    effects: Annotated[
        str | None,
        typer.Option(
            "--effects",
            metavar="A,B",
            help="Search these effects only (see cdia effects); all if left out.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    extra: Annotated[
        list[str] | None,
        typer.Option(
            "--extra",
            metavar="EXPRESSION[@JOINT]",
            help="Search an effect of your own as well, such as 'sin(3*q)*dq'; may be repeated.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    all_candidates: Annotated[
        bool, typer.Option("--all", help="Show the whole ranking of single effects.", rich_help_panel=OUTPUT)
    ] = False,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    check: Check = True,
    report: Report = None,
    json: Json = None,
) -> None:
    """Find the physical effects that a model lacks, with their numbers, and add them.

    The error is shown step by step, also on data that was not fitted, beside the floor that noise sets.
    """
    unseen = holdout or []
    require_writable(save, report, json, inputs=[*logs, *unseen])
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import discovery
        from cdia_pin.logs.conditioning import Conditioning

        settings = discovery.DiscoverySettings(
            conditioning=Conditioning(cutoff=cutoff),
            effects=_named(effects),
            extra=_expressions(extra or [], known.robot),
        )
        reading = Reading(gains, joint_map, convert, topic)
        given, checks = read_logs(logs, known.robot, reading, check=check, tell=tell)
        held_out, _ = read_logs(unseen, known.robot, reading, check=check, tell=tell)
        found = discovery.discover(known, given, holdout=held_out or None, settings=settings, progress=tell)
    show_inputs(console, known, given, held_out)
    show_discovery(console, found, ranking=None if all_candidates else 5)
    files = write_all(*discovery_outputs(found, ...))
    say_written(console, files)


def _named(text: str | None) -> tuple[str, ...] | None:
    """Effects named with commas between them; raises EffectError before a log is read."""
    from cdia_pin.effects import EFFECTS
    from cdia_pin.errors import EffectError, unknown_name

    if text is None:
        return None
    names = tuple(n.strip() for n in text.split(",") if n.strip())
    if not names:
        raise CommandError("--effects names none: write --effects coulomb_friction,payload")
    for name in names:
        if name not in EFFECTS:
            raise EffectError(unknown_name("effect", name, EFFECTS))
    return names


def _expressions(texts: list[str], robot: RobotModel) -> tuple[Effect, ...]:
    """A user's own effects; raises EffectError or RobotError before a log is read."""
    from cdia_pin.effects import from_expression

    out = []
    for given in texts:
        text, _, joint = given.partition("@")
        if joint:
            robot.joint_index(joint.strip())
        out.append(from_expression(text.strip(), joint.strip() or None))
    return tuple(out)
