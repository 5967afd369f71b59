"""The option ``--condition``: which logs were recorded alike, cold or warm, loaded or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.failures import CommandError

if TYPE_CHECKING:
    from cdia_pin.logs import Log

Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--condition",
        metavar="NAME=LOG,LOG",
        show_default=False,
        help="Logs recorded under one condition, such as warm=b.csv,c.csv; each log is its own if left out.",
    ),
]


def parse_conditions(texts: Sequence[str] | None, logs: Sequence[Path]) -> dict[Path, str]:
    """Return the condition of each log that has one, by its path.

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
            path = next((p for p in logs if p.resolve() == file.resolve()), None)
            if path is None:
                raise CommandError(
                    f"--condition {text}: {file} is not among the logs {', '.join(map(str, logs))}"
                )
            if out.setdefault(path, name) != name:
                raise CommandError(f"{path} is given two conditions, {out[path]} and {name}")
    return out


def under(conditions: dict[Path, str], logs: Sequence[Log], paths: Sequence[Path]) -> list[Log]:
    """Return logs with their conditions."""
    return [replace(log, condition=conditions.get(path, "")) for log, path in zip(logs, paths, strict=True)]
