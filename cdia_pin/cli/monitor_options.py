"""Options of a monitor, shared by ``monitor``, ``simulate`` and ``view``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin.cli.failures import CommandError

MONITOR = "Monitor"
DEFAULT_ENGINE = "momentum"

Healthy = Annotated[
    list[Path] | None,
    typer.Option(
        "--healthy",
        metavar="LOG",
        show_default=False,
        help="Run of the healthy arm, from which thresholds are learned; may be repeated.",
        rich_help_panel=MONITOR,
    ),
]
Bank = Annotated[
    list[str] | None,
    typer.Option(
        "--bank",
        metavar="EFFECT",
        show_default=False,
        help="Known effect that is tested on every joint, such as 'position_ripple: frequency=7'; may be repeated. "
        "Common ones that the torque sensors see if left out.",
        rich_help_panel=MONITOR,
    ),
]
Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        metavar="NAME",
        help="momentum, or thesis: the scheme of the thesis with corrected equations.",
        rich_help_panel=MONITOR,
    ),
]
Threshold = Annotated[
    list[str] | None,
    typer.Option(
        "--threshold",
        metavar="JOINT=VALUE",
        show_default=False,
        help="Largest healthy residual of a joint \\[N·m or N], for every joint, in place of healthy runs.",
        rich_help_panel=MONITOR,
    ),
]


def thresholds(texts: list[str] | None) -> dict[str, float] | None:
    """Return the thresholds of the option ``--threshold`` by joint [N·m or N]; None without any.

    Args:
        texts: ``JOINT=VALUE``; several may stand in one text, with commas.

    Raises:
        CommandError: If a text is something else.
    """
    if not texts:
        return None
    out = {}
    for text in (part.strip() for one in texts for part in one.split(",")):
        joint, sign, value = (part.strip() for part in text.partition("="))
        try:
            out[joint] = float(value)
        except ValueError:
            sign = ""
        if not (joint and sign):
            raise CommandError(f"--threshold takes JOINT=VALUE, such as elbow_joint=1.5, given '{text}'")
    return out
