"""Options of the command lines that draw effects for measured logs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from benchmarks.measured_logs import folder
from benchmarks.real_residuals.cases import REPORTING, SAMPLE, SUITES
from benchmarks.real_residuals.recordings import ARMS


def add_options(given: argparse.ArgumentParser, sizes: Sequence[int], page: str) -> None:
    """Add which draws are run, on which arms, and what becomes of the outcomes.

    Args:
        given: The parser.
        sizes: Of inserted effects [%].
        page: Name of the page that is written if all is run.
    """
    folder.add_option(given)
    given.add_argument("--suite", choices=SUITES, default=REPORTING, help="which draws")
    given.add_argument("--arms", nargs="+", choices=list(ARMS), default=list(ARMS))
    given.add_argument(
        "--sizes", nargs="+", type=int, choices=sizes, default=list(sizes), help="[%%] of torque"
    )
    given.add_argument("--jobs", type=int, default=2, help="processes")
    given.add_argument(
        "--sample", type=int, nargs="?", const=SAMPLE, metavar="N", help=f"one draw in N ({SAMPLE}), printed"
    )
    given.add_argument("--kept", action="store_true", help="run nothing: print what is kept")
    given.add_argument("--out", type=Path, help=f"page to write; docs/{page} if all is run")
