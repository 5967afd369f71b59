"""Measure the full identification on logs of real arms, and write docs/results-measured.md.

Usage:
    python -m benchmarks.measured_logs                     # some minutes
    python -m benchmarks.measured_logs --data FOLDER       # measured logs in a folder of one's own
    python -m benchmarks.measured_logs --figaroh PYTHON    # interpreter of an environment with figaroh
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.measured_logs import folder
from benchmarks.measured_logs.cases import cases
from benchmarks.measured_logs.measuring import CUTOFFS, measure
from benchmarks.measured_logs.page import page, skipped
from benchmarks.measured_logs.trust import causes
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.peers.figaroh_process import PYTHON
from benchmarks.publishing import publish


def main() -> None:
    """Measure every case and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.measured_logs", description=__doc__.splitlines()[0]
    )
    folder.add_option(given)
    given.add_argument(
        "--figaroh",
        default=PYTHON or sys.executable,
        help="interpreter of an environment with figaroh (or $CDIA_FIGAROH_PYTHON)",
    )
    given.add_argument(
        "--out", type=Path, default=CHECKOUT / "docs" / "results-measured.md", help="page to write"
    )
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        publish(skipped(), options.out)
        return
    measured, lacking = [], {}
    for case in cases(options.data):
        for cutoff in CUTOFFS:
            measured.append(measure(case, cutoff, options.figaroh, tell))
            if cutoff == CUTOFFS[0]:
                lacking[case.name] = causes(measured[-1].bench)
    publish(page(measured, lacking), options.out)


if __name__ == "__main__":
    main()
