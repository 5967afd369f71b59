"""Measured logs of real arms: what `cdia discover` and `cdia identify` make of them.

python -m benchmarks                  # cdia discover, run as a user would run it: docs/results.md
python -m benchmarks.measured_logs    # full identification, joint by joint: docs/results-measured.md
"""

from benchmarks.measured_logs.jobs import (
    ALONE,
    FOURIER,
    JOBS,
    MAIN,
    PANDA,
    UR10,
    Errors,
    Job,
    Outcome,
    compare_formats,
    run,
)

__all__ = [
    "ALONE",
    "FOURIER",
    "JOBS",
    "MAIN",
    "PANDA",
    "UR10",
    "Errors",
    "Job",
    "Outcome",
    "compare_formats",
    "run",
]
