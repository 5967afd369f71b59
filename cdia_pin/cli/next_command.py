"""The command to type next, made from what the user typed: the same files and the same ways to read them."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Sequence
from enum import Enum
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cdia_pin.cli.options import READING
from cdia_pin.phrases import printable

if TYPE_CHECKING:
    import typer
    from rich.console import Console

    from cdia_pin.logs import LogCheck

MENDING = re.compile(r"--(?:convert|joint-map) [^\s;,]+(?:,[^\s;,]+)*")  # options that an advice names
# Options that hold for every command on the same logs, beside those of how logs are read.
CARRIED = {"robot", "model", "cutoff", "environment", "contact", "mounted", "condition"}


def show_next(console: Console, line: str) -> None:
    """Print the command to type next, in one line however long it is.

    Args:
        console: Where.
        line: The command; nothing is printed if it is empty.
    """
    if not line:
        return
    console.print(f"next: {printable(line)}", style="dim", markup=False, soft_wrap=True)


def command_line(*words: object) -> str:
    """Return a command as it is typed.

    Args:
        *words: What follows ``cdia``.
    """
    return shlex.join(["cdia", *map(str, words)])


def follow(ctx: typer.Context, command: str, *arguments: str | Path, **options: Any) -> str:
    """Return another command with the options that the user gave and that it has too.

    Args:
        ctx: Of the present command.
        command: Name of the next one.
        *arguments: Its arguments.
        **options: Its options by parameter name; they replace what the user gave, and None leaves an option out.
    """
    nxt = ctx.find_root().command.commands[command]  # type: ignore[attr-defined]
    given = {p.name: ctx.params[p.name] for p in ctx.command.params if _carries(ctx, p)}
    for name, value in _answered(ctx).items():
        given[name] = [*(given.get(name) or ()), value]
    given |= options
    words = list(map(str, arguments))
    for parameter in nxt.params:
        words += _words(parameter, given.get(parameter.name))
    return command_line(command, *words)


def follow_checks(
    ctx: typer.Context, checks: Sequence[LogCheck], command: str, *logs: Path, **options: Any
) -> str:
    """Return another command on checked logs; where they contradict their robot, the present one with what mends them.

    Args:
        ctx: Of the present command.
        checks: Checks of the logs.
        command: Name of the next one.
        *logs: The logs, its arguments.
        **options: As of `follow`.

    Returns:
        The command; empty if nothing mends the logs, or not all of them alike.
    """
    if any(check.obstacles or _fitting_arms(check) for check in checks):
        return mended(ctx, checks)
    return follow(ctx, command, *logs, **options)


def mended(ctx: typer.Context, checks: Sequence[LogCheck]) -> str:
    """Return the command that the user typed, with the arm that fits its logs or with the options that mend them.

    Args:
        ctx: Of the present command.
        checks: Checks of the logs.

    Returns:
        The command; empty if nothing mends the logs, or not all of them alike.
    """
    arms = {_fitting_arms(check) for check in checks}
    if any(arms):
        return again(ctx, robot=arms.pop()[0]) if len(arms) == 1 else ""
    mends = {
        tuple(dict.fromkeys(option for f in check.obstacles for option in MENDING.findall(f.advice)))
        for check in checks
    }
    if len(mends) != 1:
        return ""
    words = [word for option in mends.pop() if option not in (ctx.obj or "") for word in option.split()]
    return with_words(ctx, *words) if words else ""


def _fitting_arms(check: LogCheck) -> tuple[str, ...]:
    """Return the arms that fit a log better and can read it: their joints have the same names."""
    return tuple(str(f.value["best"]) for f in check.about("robot") if f.value["same_joints"])


def again(ctx: typer.Context, **options: Any) -> str:
    """Return the command that the user typed, with more options.

    Args:
        ctx: Of the present command.
        **options: Options of one value by parameter name; a value replaces the one that was typed.
    """
    chosen = [p for p in ctx.command.params if options.get(p.name) is not None]
    words = (word for p in chosen for word in _words(p, options[p.name]))
    return with_words(ctx, *words, instead_of=[name for p in chosen for name in p.opts])


def compare_saved(ctx: typer.Context, logs: Sequence[Path], save: Path | None) -> str:
    """Return the comparison of logs with a saved model; if none was saved, the present command that saves it.

    Args:
        ctx: Of the present command.
        logs: The logs.
        save: File of the model, or None.
    """
    return follow(ctx, "compare", *logs, model=save) if save else again(ctx, save=free("model.json"))


def with_words(ctx: typer.Context, *words: str, instead_of: Sequence[str] = ()) -> str:
    """Return the command that the user typed, with more words before its arguments.

    Args:
        ctx: Of the present command.
        *words: Such as ``--convert``, ``angle=deg``.
        instead_of: Options that are left out with their values, such as ``--robot``.
    """
    program, command, *typed = shlex.split(ctx.obj or f"cdia {ctx.info_name}")
    answered = (word for p in ctx.command.params for word in _words(p, _answered(ctx).get(p.name)))
    return shlex.join([program, command, *words, *answered, *_without(ctx, typed, instead_of)])


def ways_of(ctx: typer.Context) -> list[dict[str, str]]:
    """Return how the logs of a command were read beyond what was typed; a reading adds to it.

    Args:
        ctx: Of the present command.

    Returns:
        The options that a dialogue answered, once for logs that were read alike; {} for logs that needed none.
    """
    ways: list[dict[str, str]] = ctx.meta.setdefault("ways to read logs", [])
    return ways


def free(name: str) -> Path:
    """Return a name for a new file, numbered where there is such a file already.

    Args:
        name: The name that is wanted.
    """
    path, count = Path(name), 1
    while path.exists():
        count += 1
        path = Path(name).with_stem(f"{Path(name).stem}{count}")
    return path


def _without(ctx: typer.Context, typed: Sequence[str], options: Sequence[str]) -> Iterator[str]:
    """Yield what was typed but for options and their values, such as ``-r ur5`` or ``--robot=ur5``."""
    rest = iter(typed)
    valued = {name for p in ctx.command.params for name in p.opts if not getattr(p, "is_flag", True)}
    for word in rest:
        if word in valued:  # what follows is its value, whatever it looks like
            value = [*islice(rest, 1)]
            yield from () if word in options else (word, *value)
        elif not any(word.startswith(f"{o}=" if o.startswith("--") else o) for o in options):
            yield word


def _answered(ctx: typer.Context) -> dict[str, str]:
    """Return the options that a dialogue answered; none where logs differ in them, which no command can say."""
    ways = ways_of(ctx)
    return ways[0] if len(ways) == 1 else {}


def _carries(ctx: typer.Context, parameter: Any) -> bool:
    """Tell whether the user typed an option that the next command takes over."""
    source = ctx.get_parameter_source(parameter.name)
    if source is None or source.name != "COMMANDLINE" or parameter.name not in ctx.params:
        return False
    return parameter.name in CARRIED or getattr(parameter, "rich_help_panel", None) == READING


def _words(parameter: Any, value: object) -> Iterator[str]:
    """Yield an option as it is typed; nothing for arguments and for options without a value."""
    if value is None or parameter.param_type_name != "option":
        return
    if isinstance(value, bool):
        yield from (parameter.opts if value else parameter.secondary_opts)[:1]
        return
    if getattr(parameter, "nargs", 1) > 1:
        yield parameter.opts[0]
        yield from map(str, value)  # type: ignore[call-overload]
        return
    for one in value if isinstance(value, list | tuple) else [value]:
        yield parameter.opts[0]
        yield str(one.value if isinstance(one, Enum) else one)
