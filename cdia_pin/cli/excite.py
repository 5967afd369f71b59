"""``cdia excite``: a safe motion that makes parameters identifiable, or distinguishes two effects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cdia_pin.cli.console import progress, stdout, warn
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import OUTPUT, Columns, Episode, Format, Gains, Json, Model, Robot
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.ranges import DURATION, LENGTH, LIMIT_SHARE, RATE, SEED

if TYPE_CHECKING:
    from cdia_pin.effects import Effect
    from cdia_pin.robot import RobotModel

LIMITS = "Limits"
MOST_ACCELERATION = 1e6  # [rad/s² or m/s²], ten thousand times what arms do
FURTHEST = 10.0  # [m], of a floor from the base; no arm reaches so far
RECORDED = "run.csv"  # name of the log in the advice
QUESTION = "Purpose"


def excite(
    ctx: typer.Context,
    *,
    robot: Robot,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", metavar="CSV", show_default=False, help="Motion to write (.csv)."),
    ],
    between: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--between",
            metavar="A B",
            show_default=False,
            help="Two explanations to distinguish, EFFECT@JOINT each, or several with commas.",
            rich_help_panel=QUESTION,
        ),
    ] = None,
    effects: Annotated[
        str | None,
        typer.Option(
            "--effects",
            metavar="A,B",
            show_default=False,
            help="Effects whose parameters should be identifiable, EFFECT@JOINT each; those of the model, or "
            "friction and inertia of all joints, if left out.",
            rich_help_panel=QUESTION,
        ),
    ] = None,
    model: Model = None,
    after: Annotated[
        list[Path] | None,
        typer.Option(
            "--after",
            metavar="LOG",
            show_default=False,
            help="Existing log, to measure the gain against; may be repeated.",
            rich_help_panel=QUESTION,
        ),
    ] = None,
    gains: Gains = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    duration: Annotated[
        float, typer.Option("--duration", metavar="S", help="Length \\[s].", callback=DURATION)
    ] = 30.0,
    rate: Annotated[
        float, typer.Option("--rate", metavar="HZ", help="Samples per second \\[Hz].", callback=RATE)
    ] = 250.0,
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="Of the search.", callback=SEED)] = 0,
    speed: Annotated[
        float,
        typer.Option(
            "--speed",
            metavar="SHARE",
            help="Of the velocity limits.",
            rich_help_panel=LIMITS,
            callback=LIMIT_SHARE,
        ),
    ] = 0.8,
    acceleration: Annotated[
        list[str] | None,
        typer.Option(
            "--acceleration",
            metavar="A|JOINT=A",
            show_default=False,
            help="Largest acceleration \\[rad/s², m/s²], of all joints or of one; may be repeated. "
            "Full speed in half a second if left out: a URDF has no such limit.",
            rich_help_panel=LIMITS,
        ),
    ] = None,
    effort: Annotated[
        float,
        typer.Option(
            "--effort",
            metavar="SHARE",
            help="Of the effort limits.",
            rich_help_panel=LIMITS,
            callback=LIMIT_SHARE,
        ),
    ] = 0.8,
    clearance: Annotated[
        float,
        typer.Option(
            "--clearance",
            metavar="M",
            help="Between links, and to the floor \\[m].",
            rich_help_panel=LIMITS,
            callback=LENGTH,
        ),
    ] = 0.01,
    floor: Annotated[
        str,
        typer.Option(
            "--floor",
            metavar="M",
            help="Height of a floor above the base's origin \\[m]; base: where the base stands; none.",
            rich_help_panel=LIMITS,
        ),
    ] = "base",
    srdf: Annotated[
        Path | None,
        typer.Option(
            "--srdf",
            metavar="FILE",
            show_default=False,
            help="SRDF whose disabled pairs of links are not checked; neighbours never are.",
            rich_help_panel=LIMITS,
        ),
    ] = None,
    ros: Annotated[
        Path | None,
        typer.Option(
            "--ros",
            metavar="FILE",
            show_default=False,
            help="Write it as trajectory_msgs/JointTrajectory too (.yaml).",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    json: Json = None,
) -> None:
    """Design a motion that makes parameters identifiable, or distinguishes two effects, in a log of it.

    It begins and ends at rest, keeps the limits of position, speed, acceleration and effort, and touches neither the
    arm itself nor the floor. Other obstacles are not known: check the motion before you run it.
    """
    if between and effects:
        raise CommandError("--between and --effects are two purposes: give one of them")
    if (gains or format or columns or episode is not None) and not after:
        raise CommandError("options of reading need a log: add one with --after, or leave them out")
    require_writable(ros, json, inputs=after or [], tables=[out])
    console = stdout(json)
    known = load_inputs(robot, model)
    with progress() as tell:
        from cdia_pin import excitation

        settings = excitation.ExcitationSettings(
            duration=duration,
            rate=rate,
            seed=seed,
            speed=speed,
            effort=effort,
            acceleration=accelerations(acceleration or [], known.robot),
            clearance=clearance,
            floor=floor_height(floor),
            srdf=srdf,
        )
        pair = (named(between[0], known.robot), named(between[1], known.robot)) if between else None
        wanted = named(effects, known.robot) if effects else None
        logs, _ = read_logs(
            after or [],
            known.robot,
            Reading(gains, format=format, columns=columns, episode=episode),
            check=False,
            tell=tell,
        )
        motion = excitation.excite(
            known,
            between=pair,
            effects=wanted,
            after=logs,
            settings=settings,
            progress=tell,
        )
    from cdia_pin.viewers.text_excitation import gain_words, limits_table

    for sentence in motion.warnings:
        warn(sentence)
    show_inputs(console, known, logs, notes=gains is not None)  # how they were used
    console.print(limits_table(motion))
    console.print(gain_words(motion), markup=False)
    console.print()
    write_all(
        console,
        (out, motion.to_csv),
        (ros, motion.to_ros),
        (json, lambda file: write_json(motion.to_dict() | {"command": ctx.obj}, file)),
    )
    console.print(f"Drive {out} on the arm, and record it as {RECORDED}.", markup=False, soft_wrap=True)
    show_next(console, command_line("check", RECORDED, "--robot", robot))


def named(text: str, robot: RobotModel) -> list[Effect]:
    """Return effects with commas between them.

    Args:
        text: Such as ``payload,coulomb_friction@elbow_joint``.
        robot: Checks the joint names.

    Raises:
        EffectError: If one is not in the vocabulary.
        RobotError: If a joint is not of the robot.
    """
    from cdia_pin.effects import parse_effect

    return [parse_effect(part.strip(), robot) for part in text.split(",")]


def accelerations(texts: list[str], robot: RobotModel) -> float | dict[str, float] | None:
    """Return largest accelerations [rad/s² or m/s²], of all joints or by joint; None where none is given.

    Args:
        texts: Values of the option, ``A`` or ``JOINT=A``.
        robot: Checks the joint names.

    Raises:
        CommandError: If one has no number.
    """
    whole, by_joint = None, {}
    for text in texts:
        joint, equals, number = text.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            raise CommandError(f"--acceleration takes A or JOINT=A with a number A, given '{text}'") from None
        if not 0 < value <= MOST_ACCELERATION:
            raise CommandError(f"--acceleration is above 0 and up to {MOST_ACCELERATION:g}, given '{text}'")
        if equals:
            robot.joint_index(joint.strip())
            by_joint[joint.strip()] = value
        else:
            whole = value
    if whole is not None and by_joint:
        return {joint: by_joint.get(joint, whole) for joint in robot.joints}
    return by_joint or whole


def floor_height(text: str) -> float | Literal["base"] | None:
    """Return the height of the floor [m], ``base``, or None for none.

    Args:
        text: Value of the option.

    Raises:
        CommandError: If it is neither a number, ``base`` nor ``none``.
    """
    word = text.strip().lower()
    if word == "base":
        return "base"
    if word == "none":
        return None
    try:
        height = float(word)
    except ValueError:
        raise CommandError(f"--floor takes a height in m, base or none, given '{text}'") from None
    if not abs(height) <= FURTHEST:
        raise CommandError(f"--floor is within {FURTHEST:g} m of the base, given '{text}'")
    return height
