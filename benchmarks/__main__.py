"""Measure `cdia compare` and `cdia discover` on measured logs, and write docs/results.md.

Hidden effects, where the truth is known, are measured by `python -m benchmarks.hidden_effects`.

Usage:
    python -m benchmarks                    # two or three minutes
    python -m benchmarks --data FOLDER      # measured logs in a folder of one's own
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from benchmarks.measured_logs import folder, jobs
from benchmarks.measured_logs.discover_page import Measured, page
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish


def main() -> None:
    """Run the benchmark and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure cdia compare and cdia discover on measured logs."
    )
    folder.add_option(given)
    given.add_argument("--out", type=Path, default=CHECKOUT / "docs" / "results.md", help="page to write")
    options = given.parse_args()
    publish(page(_measured(options.data)), options.out)


def _measured(data: Path) -> Measured | None:
    if not folder.are_there(data):
        tell("measured logs: not there, skipped")
        return None
    outcomes = []
    with tempfile.TemporaryDirectory() as out:
        for job in jobs.JOBS:
            outcomes.append(last := jobs.run(job, data, Path(out)))
            said = last.failure or f"{last.found['verdict']}, {len(last.found['effects'])} effects"
            tell(f"{last.seconds:5.1f} s  cdia discover {job.log}: {said}")
        return outcomes, jobs.compare_formats(data, Path(out))


if __name__ == "__main__":
    main()
