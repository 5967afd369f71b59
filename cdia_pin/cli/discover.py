"""``cdia discover``: the physical effects that a model lacks."""

from __future__ import annotations

from functools import partial
from pathlib import Path
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
from cdia_pin.cli.conditions import Conditions, PerLog, parse_conditions, parse_per_log
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.discovery_files import DiscoveryFiles
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, doubts, load_inputs, read_logs, require_unseen, show_inputs
from cdia_pin.cli.next_command import again, follow, free, mended, show_next, ways_of
from cdia_pin.cli.options import (
    OUTPUT,
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
from cdia_pin.cli.unfinished import UnfinishedSearch

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery
    from cdia_pin.effects import Effect
    from cdia_pin.robot import RobotModel

SEARCH = "Search"


def discover(
    ctx: typer.Context,
    logs: Logs,
    *,
    robot: Robot,
    model: Model = None,
    holdout: Holdout = None,
    save: Save = None,
    effects: Annotated[
        str | None,
        typer.Option(
            "--effects",
            metavar="A,B",
            show_default=False,
            help="Search these effects only (see cdia effects); all if left out.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    extra: Annotated[
        list[str] | None,
        typer.Option(
            "--extra",
            metavar="EXPRESSION[@JOINT]",
            show_default=False,
            help="Search an effect of your own as well, such as 'sin(3*q)*dq'; may be repeated.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    everything: Annotated[
        bool,
        typer.Option(
            "--all",
            help="Show every effect with its numbers, every step, and the whole ranking.",
            rich_help_panel=OUTPUT,
        ),
    ] = False,
    environment: Environment = Surroundings.AIR,
    contact: Contact = False,
    mounted: Mounted = Mounting.UPRIGHT,
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
    anyway: Annotated[
        bool,
        typer.Option(
            "--anyway",
            help="Search also where the check finds wrong signs, units or joints, which would mislead the search.",
            rich_help_panel=SEARCH,
        ),
    ] = False,
    report: Report = None,
    json: Json = None,
) -> None:
    """Find the physical effects that a model lacks, with their numbers, and add them.

    The error is shown step by step, also on data that was not fitted, beside the noise floor. A log whose signs, units
    or order of joints are wrong is refused, with what mends it.
    """
    unseen = holdout or []
    files = DiscoveryFiles(save, json, report)
    files.require_writable([*logs, *unseen])
    require_unseen(unseen, logs)
    conditions = parse_conditions(condition, [*logs, *unseen])
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import discovery
        from cdia_pin.logs.conditioning import Conditioning
        from cdia_pin.selection import DiscoverySettings

        conditioning = Conditioning(cutoff=cutoff)
        settings = DiscoverySettings(
            conditioning=conditioning,
            effects=named_effects(effects),
            extra=own_effects(extra or [], known.robot),
            per_log=parse_per_log(per_log, logs, conditions, known.robot),
            expected=expected_effects(environment, contact, mounted),
        )
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
        read = partial(
            read_logs,
            robot=known.robot,
            reading=reading,
            check=check,
            tell=tell,
            refuse=not anyway,
            like=known,
        )
        given, checks = read(logs)
        held_out, later = read(unseen)
        unfinished = UnfinishedSearch.beside(
            save, ctx.obj or "", [model, known.robot.urdf, gains], [*given, *held_out]
        )
        with unfinished.resumed(known.robot) as resumed:
            found = discovery.discover(
                known,
                given,
                holdout=held_out or None,
                settings=settings,
                progress=tell,
                **resumed,
            )
    from cdia_pin.viewers import discovery_table
    from cdia_pin.viewers.text_ranking import ranking_table

    show_inputs(console, known, given, held_out)
    if everything and found.ranking:
        console.print(ranking_table(found, everything))
    console.print(discovery_table(found, everything))
    files.write(console, found, known, given, conditioning=conditioning, checks=checks, command=ctx.obj)
    unfinished.forget()
    if found.steps and not everything:
        console.print("--all shows the numbers.", style="dim")
    for doubt in doubts([*checks, *later]):
        console.print(f"This result is doubtful. {doubt}.", style="yellow", markup=False)
    show_next(console, mended(ctx, [*checks, *later]) or _following(ctx, found, logs, save))


def _following(ctx: typer.Context, found: Discovery, logs: list[Path], save: Path | None) -> str:
    """Return the command to type next: keep the model, use it, or drive a motion that shows more."""
    if not found.steps:
        return follow(ctx, "monitor", logs[0])
    if save is None:
        return again(ctx, save=free("model.json"))
    if found.verdict == "unexplained":
        return follow(ctx, "excite", model=save, out=free("motion.csv"))
    from cdia_pin.exports import FORMATS, first_format

    name = first_format(found.model)
    files = {name: FORMATS[name].file} if name else {"ranges": "ranges.json"}  # which every term has
    return follow(ctx, "export", model=save, **{key: free(file) for key, file in files.items()})


def named_effects(text: str | None) -> tuple[str, ...] | None:
    """Return effects named with commas between them, checked before a log is read.

    Args:
        text: Value of the option; None for all effects.

    Raises:
        EffectError: If one is not in the vocabulary.
        CommandError: If it names none.
    """
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


def own_effects(texts: list[str], robot: RobotModel) -> tuple[Effect, ...]:
    """Return a user's own effects, checked before a log is read.

    Args:
        texts: Expressions, each with ``@JOINT`` or for every joint.
        robot: Checks the joint names.

    Raises:
        EffectError: If an expression cannot be read.
        RobotError: If a joint is not of the robot.
    """
    from cdia_pin.effects import from_expression

    out = []
    for given in texts:
        text, _, joint = given.partition("@")
        if joint:
            robot.joint_index(joint.strip())
        out.append(from_expression(text.strip(), joint.strip() or None))
    return tuple(out)
