"""The options ``--condition`` and ``--per-log``: logs recorded alike, and effects with parameters per log."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.failures import CommandError
from cdia_pin.input_files import resolved

if TYPE_CHECKING:
    from cdia_pin.robot import RobotModel

Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--condition",
        metavar="NAME=LOG,LOG",
        show_default=False,
        help="Logs recorded under one condition, such as warm=b.csv,c.csv; each log is its own if left out.",
    ),
]


PerLog = Annotated[
    list[str] | None,
    typer.Option(
        "--per-log",
        metavar="EFFECT[@JOINT]",
        show_default=False,
        help="Effect with parameters of its own in each log or condition, whatever the evidence; may be repeated.",
    ),
]


def parse_per_log(
    texts: Sequence[str] | None, logs: Sequence[Path], conditions: dict[Path, str], robot: RobotModel
) -> tuple[str, ...]:
    """Return the names or labels of effects that have parameters per log.

    Args:
        texts: Values of the option, each one effect or several with commas.
        logs: The logs that are fitted.
        conditions: Condition of each log that has one, by its path.
        robot: Checks the joint names.

    Raises:
        CommandError: If there is only one log or condition, or the effect is an encoder offset.
        EffectError: If an effect is not in the vocabulary.
        RobotError: If a joint is not of the robot.
    """
    from cdia_pin.effects import EFFECTS, Channel, parse_effect
    from cdia_pin.errors import EffectError, unknown_name

    asked = tuple(part.strip() for text in texts or [] for part in text.split(",") if part.strip())
    if asked and len({conditions.get(p, p) for p in logs}) < 2:
        raise CommandError(f"--per-log {asked[0]} needs logs of at least two conditions")
    for text in asked:
        name = text.partition("@")[0]
        if name not in EFFECTS:
            raise EffectError(unknown_name("effect", name, EFFECTS))
        example = EFFECTS[name].from_scope(robot.joints[: len(EFFECTS[name].scope_fields)], {})
        if example.traits.channel is Channel.POSITION_READING:
            raise CommandError(f"--per-log {text}: the zero of an encoder has one value in a model")
        if "@" in text:
            parse_effect(text, robot)
    return asked


def parse_conditions(texts: Sequence[str] | None, logs: Sequence[Path]) -> dict[Path, str]:
    """Return the condition of each log that has one, by its path.

    Args:
        texts: Values of the option, ``NAME=LOG,LOG``.
        logs: The logs that are given.

    Raises:
        CommandError: If a text is not NAME=LOG, names a log that is not given, or a log has two conditions.
    """
    out: dict[Path, str] = {}
    for text in texts or []:
        name, equals, files = (part.strip() for part in text.partition("="))
        named = [Path(f.strip()) for f in files.split(",") if f.strip()]
        if not (name and equals and named):
            raise CommandError(f"--condition {text}: write it as NAME=LOG,LOG")
        for file in named:
            path = next((p for p in logs if resolved(p) == resolved(file)), None)
            if path is None:
                raise CommandError(
                    f"--condition {text}: {file} is not among the logs {', '.join(map(str, logs))}"
                )
            if out.setdefault(path, name) != name:
                raise CommandError(f"{path} is given two conditions, {out[path]} and {name}")
    return out
