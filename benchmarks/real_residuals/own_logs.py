"""Put known effects into the logs of any arm, and ask `compare` for them: how far it can be trusted on that arm.

Usage:
    python -m benchmarks.real_residuals.own_logs arm.urdf monday.csv tuesday.csv   # every pair of them
    python -m benchmarks.real_residuals.own_logs ur10e exciting.csv --gains drive_gains.json --out page.md   # halves

Nothing may have changed on the arm between the logs. A pair takes a minute or two.
"""

from __future__ import annotations

import argparse
import shlex
from itertools import permutations
from pathlib import Path

from benchmarks.outcomes import tell
from benchmarks.publishing import publish, stated
from benchmarks.real_residuals.cases import COMPARE, REPORTING, SIZES, SUITES, planned
from benchmarks.real_residuals.page import page_of_arm
from benchmarks.real_residuals.pairs import Pair
from benchmarks.real_residuals.recordings import ARMS, MeasuredArm, Recording
from benchmarks.real_residuals.trial import run_case
from cdia_pin import load_robot
from cdia_pin.errors import CdiaError


def main() -> None:
    """Run the cases and print the page, or write it."""
    given = _parser()
    options = given.parse_args()
    folders = {log.resolve().parent for log in options.logs}
    missing = [str(log) for log in options.logs if not log.is_file() or log.suffix != ".csv"]
    if missing or len(folders) > 1:
        why = f"not a CSV file: {', '.join(missing)}" if missing else "all logs must be in one folder"
        given.error(why)
    try:
        name = _arm(options.robot, options.gains, options.behind_gear, *folders)
        logs = [Recording(name, log.stem) for log in options.logs]
        for log in logs:
            log.read()
    except CdiaError as why:
        given.error(str(why))
    two = logs[0].halves() if len(logs) == 1 else logs
    pairs = [Pair(a, b) for a, b in permutations(two, 2)]
    cases = planned(options.suite, [name], options.sizes, [COMPARE], among=pairs)[: options.limit]
    outcomes = []
    for k, case in enumerate(cases, 1):
        outcomes.append(run_case(case))
        tell(f"{k} of {len(cases)}  {outcomes[-1].answer:8} {case.id}")
    publish(page_of_arm(name, outcomes, _command(given, options), options.suite), options.out)


def _arm(robot: str, gains: Path | None, behind_gear: bool, folder: Path) -> str:
    """Let the benchmark know an arm, and return its name."""
    urdf = str(Path(robot).resolve()) if Path(robot).is_file() else robot
    name = load_robot(urdf).name
    tables = str(gains.resolve()) if gains else ""
    side = "link" if behind_gear else None
    ARMS[name] = MeasuredArm(name, urdf, tables, behind_gear, str(folder), side)
    return name


def _command(given: argparse.ArgumentParser, options: argparse.Namespace) -> str:
    """Return the command without folders, which are of this machine alone."""
    named = argparse.Namespace(**{**vars(options), "gains": options.gains and options.gains.name})
    files = shlex.join([Path(options.robot).name, *(log.name for log in options.logs)])
    said = stated(given, named, ("gains", "behind_gear", "suite", "sizes", "limit"))
    return said.replace(given.prog, f"{given.prog} {files}", 1)


def _parser() -> argparse.ArgumentParser:
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.real_residuals.own_logs",
        description="Put known effects into the logs of any arm, and ask `compare` for them.",
    )
    given.add_argument("robot", help="URDF, or a name of `cdia robots`")
    given.add_argument("logs", nargs="+", type=Path, help="CSV files of one folder; of one log, its halves")
    given.add_argument("--gains", type=Path, help="drive gains, where the logs have motor currents")
    given.add_argument("--behind-gear", action="store_true", help="torque sensors are behind the gears")
    given.add_argument("--suite", choices=SUITES, default=REPORTING, help="which draws")
    given.add_argument("--sizes", nargs="+", type=int, choices=SIZES, default=[25, 10], help="[%%] of torque")
    given.add_argument("--limit", type=int, help="most cases to run")
    given.add_argument("--out", type=Path, help="page to write; printed without it")
    return given


if __name__ == "__main__":
    main()
