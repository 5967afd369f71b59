"""Measure the full identification on logs of real arms, and write docs/results-measured.md.

Usage:
    python -m benchmarks.measured_logs                     # some minutes
    python -m benchmarks.measured_logs --data FOLDER       # measured logs in a folder of one's own
    python -m benchmarks.measured_logs --figaroh PYTHON    # interpreter of an environment with figaroh
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from benchmarks.measured_logs.cases import cases
from benchmarks.measured_logs.measuring import CUTOFFS, measure
from benchmarks.measured_logs.page import page, skipped
from benchmarks.measured_logs.trust import causes

CHECKOUT = Path(__file__).resolve().parents[2]
BESIDE = CHECKOUT.parent / "shared" / "data"
VARIABLE = "CDIA_MEASURED_LOGS"


def main() -> None:
    """Measure every case and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.measured_logs", description=__doc__.splitlines()[0]
    )
    default = Path(os.environ.get(VARIABLE, BESIDE))
    given.add_argument("--data", type=Path, default=default, help=f"folder of measured logs (or ${VARIABLE})")
    given.add_argument("--figaroh", default=sys.executable, help="interpreter of an environment with figaroh")
    given.add_argument(
        "--out", type=Path, default=CHECKOUT / "docs" / "results-measured.md", help="page to write"
    )
    options = given.parse_args()
    if not (options.data / "ur10").is_dir():
        options.out.write_text(skipped(VARIABLE), encoding="utf-8")
        _tell("measured logs: not there, skipped")
        return
    measured, lacking = [], {}
    for case in cases(options.data):
        for cutoff in CUTOFFS:
            measured.append(measure(case, cutoff, options.figaroh, _tell))
            if cutoff == CUTOFFS[0]:
                lacking[case.name] = causes(measured[-1].bench)
    options.out.write_text(page(measured, lacking), encoding="utf-8")
    _tell(f"wrote {options.out.name}")


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
