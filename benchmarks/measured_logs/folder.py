"""Where the measured logs are: beside the checkout, or where an option or a variable says."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from benchmarks.outcomes import CHECKOUT

BESIDE = CHECKOUT.parent / "shared" / "data"
VARIABLE = "CDIA_MEASURED_LOGS"
ABSENT = (
    "**Skipped: the measured logs are absent.** They have licences of their own and do not ship; give their folder "
    f"with `--data` or in `{VARIABLE}`."
)


def folder() -> Path:
    """Return the folder that the variable names, or the one beside the checkout."""
    return Path(os.environ.get(VARIABLE, BESIDE))


def add_option(parser: argparse.ArgumentParser) -> None:
    """Let a command take the folder as ``--data``."""
    parser.add_argument(
        "--data", type=Path, default=folder(), help=f"folder of measured logs (or ${VARIABLE})"
    )


def are_there(data: Path) -> bool:
    """Return whether a folder holds them."""
    return (data / "ur10").is_dir()
