"""The golden set: two states of the code must give the same answers to 1e-9.

python -m benchmarks.golden --logs .cache/golden      # make the seeded logs, once
python -m benchmarks.golden --run OUT.json            # run the cases with the cdia_pin that Python imports
python -m benchmarks.golden --compare A.json B.json   # what differs; exit 1 if anything does
python -m benchmarks.golden --against REVISION        # all of it: this checkout against a revision
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import cdia_pin
from benchmarks.golden import logs, run
from benchmarks.golden.compare import differences
from benchmarks.measured_logs import folder
from benchmarks.outcomes import CHECKOUT, environment_of

SHOWN = 12  # differences of a case that are printed
LOGS = CHECKOUT / ".cache" / "golden"


def main(arguments: Sequence[str] | None = None) -> int:
    """Make logs, run cases or compare answers; return the exit code."""
    given = _parsed(arguments)
    if given.compare:
        return compare(*given.compare, only=given.only, quick=given.quick)
    logs.make(given.logs)
    if given.run:
        _run(given, _imported(), given.run)
    if given.against:
        return against(given)
    return 0


def compare(first: Path, second: Path, only: str = "", quick: bool = False) -> int:
    """Print what differs between two files of answers, in some cases or all, and return 1 if anything does."""
    a, b = (json.loads(f.read_text(encoding="utf-8")) for f in (first, second))
    if only or quick:
        ids = {c.id for c in run.selected(run.read_cases(), only, quick)}
        for answers in (a, b):
            answers["cases"] = {id_: answer for id_, answer in answers["cases"].items() if id_ in ids}
    found = differences(a, b)
    for case, lines in found.items():
        print(f"{case}: {len(lines)} differences")
        print("\n".join(f"  {line}" for line in lines[:SHOWN]))
    cases = a["cases"] | b["cases"]
    skipped = sum("skipped" in answer for answer in cases.values())
    print(f"{len(found)} of {len(cases)} cases differ; {skipped} skipped")
    return int(bool(found))


def against(given: argparse.Namespace) -> int:
    """Run a revision and this checkout on the same logs, and compare."""
    with tempfile.TemporaryDirectory(prefix="golden-") as out:
        then, before, after = Path(out) / "then", Path(out) / "before.json", Path(out) / "after.json"
        git = ["git", "-C", str(CHECKOUT), "worktree"]
        subprocess.run([*git, "add", "--detach", str(then), given.against], check=True, capture_output=True)
        try:
            _run(given, then, before)
            _run(given, CHECKOUT, after)
        finally:
            subprocess.run([*git, "remove", "--force", str(then)], check=False, capture_output=True)
        return compare(before, after)


def _run(given: argparse.Namespace, state: Path, out: Path) -> None:
    """Run the cases in a process that imports the package of a checkout."""
    options = [
        "--logs",
        str(given.logs),
        "--data",
        str(given.data),
        "--only",
        given.only,
        "--jobs",
        str(given.jobs),
    ]
    options += ["--quick"] if given.quick else []
    subprocess.run([sys.executable, run.__file__, str(out), *options], check=True, env=environment_of(state))


def _imported() -> Path:
    """Return the checkout whose package Python imports."""
    return Path(str(cdia_pin.__file__)).parents[1]


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.golden", description="Compare the answers of two states of the code."
    )
    parser.add_argument("--logs", type=Path, default=LOGS, metavar="DIR", help="folder of the seeded logs")
    folder.add_option(parser)
    parser.add_argument("--run", type=Path, metavar="OUT", help="run the cases and write the answers")
    parser.add_argument("--compare", type=Path, nargs=2, metavar="FILE", help="two files of answers")
    parser.add_argument("--against", metavar="REVISION", help="compare this checkout with a revision")
    parser.add_argument("--only", default="", metavar="PATTERN", help="ids that match, or have this part")
    parser.add_argument("--quick", action="store_true", help="a dozen cases, below a minute")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="cases at a time")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
