"""Measure the processor time of `discover` on measured logs, and where it goes.

Usage:
    python -m benchmarks.discovery_time                  # all arms
    python -m benchmarks.discovery_time panda ur5        # some of them
    python -m benchmarks.discovery_time panda --parts    # where the time goes
    python -m benchmarks.discovery_time --also CHECKOUT  # another state of the package by turns, at the same load
"""

from __future__ import annotations

import argparse
import cProfile
import os
import pstats
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

from benchmarks.outcomes import CHECKOUT, environment_of
from benchmarks.real_residuals.pairs import single_recordings
from benchmarks.real_residuals.recordings import Recording
from cdia_pin import Dynamics, discover

LIMIT = 10.0  # [s] of a processor, largest on any log: a person waits so long
# Functions whose time is told; one may call another.
PARTS = {
    "fits at their own optimum": "refit",
    "normal equations": "normal_equations",
    "torques of a model": "predict",
    "bodies made possible": "consistent_parameters",
    "moves of the search": "improve",
    "exchanges of nonlinear effects": "_exchanges",
    "rivals": "of",
}
FILES = {
    "improve": "moves.py",
    "_exchanges": "search.py",
    "of": "alternatives.py",
    "refit": "gauss_newton.py",
}


def main() -> None:
    """Print one line per log, or the parts of each."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.discovery_time", description="Measure the processor time of discover."
    )
    given.add_argument("arms", nargs="*", help="names of arms; all if omitted")
    given.add_argument("--parts", action="store_true", help="print where the time goes")
    given.add_argument("--also", type=Path, nargs="*", default=(), help="other checkouts to measure")
    options = given.parse_args()
    if options.also:
        by_turns(options.arms or dict.fromkeys(r.arm for r in single_recordings()), options.also)
        return
    for recording in single_recordings():
        if not options.arms or recording.arm in options.arms:
            print(parts(recording) if options.parts else measured(recording), flush=True)


def by_turns(arms: Iterable[str], others: Iterable[Path]) -> None:
    """Print the lines of other checkouts and of this one, arm by arm.

    Args:
        arms: Names of the arms.
        others: Folders of the other checkouts.
    """
    for arm in arms:
        for checkout in (*others, CHECKOUT):
            line = [sys.executable, "-m", "benchmarks.discovery_time", arm]
            done = subprocess.run(
                line, env=environment_of(checkout), cwd=checkout, check=True, capture_output=True, text=True
            )
            print(f"{checkout.name}:\n{done.stdout}", end="", flush=True)


def measured(recording: Recording) -> str:
    """Return a line with the processor time.

    Args:
        recording: The log.
    """
    log, model = recording.read(), Dynamics(recording.robot)
    start = time.process_time()
    found = discover(model, log)
    seconds = time.process_time() - start
    late = "" if seconds <= LIMIT else f", more than {LIMIT:g} s"
    return f"{recording.id:24s} {seconds:5.1f} s, {len(found.steps)} effects; load {os.getloadavg()[0]:.1f}{late}"


def parts(recording: Recording) -> str:
    """Return the share of each part in the time.

    Args:
        recording: The log.
    """
    log, model, profile = recording.read(), Dynamics(recording.robot), cProfile.Profile()
    profile.runcall(discover, model, log)
    stats = pstats.Stats(profile)
    whole = stats.total_tt  # type: ignore[attr-defined]
    lines = [recording.id]
    for words, name in PARTS.items():
        rows = [
            (calls, spent)
            for (file, _, function), (_, calls, _, spent, _) in stats.stats.items()  # type: ignore[attr-defined]
            if function == name and "cdia_pin" in file and file.endswith(FILES.get(name, ".py"))
        ]
        calls, spent = (sum(column) for column in zip(*rows, strict=True)) if rows else (0, 0.0)
        lines.append(f"  {words:32s} {spent / whole:5.0%}  {calls:6d} calls")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
