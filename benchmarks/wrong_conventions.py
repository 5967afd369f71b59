"""Read measured logs with a wrong sign, order or unit, and count how many of these `cdia check` mends.

Usage:
    python -m benchmarks.wrong_conventions            # the logs of $CDIA_MEASURED_LOGS

Each log is read as it should be, and then with each change of conventions that the search tries and that makes the
efforts clearly worse to explain. A log is mended if the search ends with the conventions that it has without the
change. The search is also run without the demand that a change fits better within quarters of the time.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import numpy as np

from benchmarks.measured_logs import folder
from benchmarks.outcomes import tell
from benchmarks.real_residuals.recordings import ARMS, robot_of
from cdia_pin.errors import CdiaError
from cdia_pin.logs import read_log
from cdia_pin.logs.checks import conventions
from cdia_pin.logs.checks.conventions import SEARCH_SAMPLES, search_conventions
from cdia_pin.logs.checks.motion import SmoothedMotion, motion_of
from cdia_pin.robot import RobotModel

RULES = {"with quarters": conventions.LASTS, "without": -np.inf}  # least gain within quarters [1]


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.wrong_conventions", description=__doc__.splitlines()[0]
    )
    folder.add_option(parser)
    data = parser.parse_args().data
    os.environ[folder.VARIABLE] = str(data)
    total = dict.fromkeys((*RULES, "wrong", "logs", "changed as given"), 0)
    for name, motion, robot in _motions(data):
        truth = search_conventions(motion, robot)
        total["logs"] += 1
        total["changed as given"] += bool(truth.steps)
        wrong = [t.conventions for t in truth.rest if t.gain < -conventions.CERTAIN]
        counts = {"wrong": len(wrong)}
        for rule, least in RULES.items():
            with patch.object(conventions, "LASTS", least):
                ends = [search_conventions(motion, robot, w).conventions for w in wrong]
            counts[rule] = ends.count(truth.conventions)
        for key, count in counts.items():
            total[key] += count
        tell(f"{name}: {counts}")
    tell(str(total))


def _motions(data: Path) -> Iterator[tuple[str, SmoothedMotion, RobotModel]]:
    for arm in ARMS.values():
        for path in sorted((data / (arm.folder or arm.name)).glob("*.csv")):
            try:
                log = read_log(path, robot_of(arm.name), gains=data / arm.gains if arm.gains else None)
            except CdiaError:  # the readings of a force sensor
                continue
            motion = motion_of(log, robot_of(arm.name).is_prismatic)
            if motion is not None and motion.moves.any():
                yield f"{arm.name}/{path.stem}", motion.thin(SEARCH_SAMPLES), robot_of(arm.name)


if __name__ == "__main__":
    main()
