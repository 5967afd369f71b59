"""Count what the source of a checkout shows of its structure, and compare it with another one.

Usage:
    python -m benchmarks.house                            # this checkout
    python -m benchmarks.house --checkout DIR             # another one
    python -m benchmarks.house --before DIR --write       # both, into docs/results-house.md
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from benchmarks.house.report import counts, page
from benchmarks.outcomes import CHECKOUT
from benchmarks.publishing import publish

MEASURED = Path(__file__).with_name("measured.json")


def main() -> None:
    """Count, and print or write the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.house", description="Count the structure of the source."
    )
    parser.add_argument("--checkout", type=Path, default=CHECKOUT, help="checkout to count in")
    parser.add_argument("--before", type=Path, help="another checkout, for a column before")
    parser.add_argument("--measured", type=Path, default=MEASURED, help="test time and install size, as JSON")
    parser.add_argument("--write", action="store_true", help="write docs/results-house.md")
    options = parser.parse_args()
    measured = json.loads(options.measured.read_text(encoding="utf-8"))
    columns = {"before": counts(options.before, measured["before"])} if options.before else {}
    columns["after" if columns else "now"] = counts(options.checkout, measured["after"])
    text = page(columns, "python -m benchmarks.house --before DIR --write" if options.before else parser.prog)
    publish(text, CHECKOUT / "docs" / "results-house.md" if options.write else None)


if __name__ == "__main__":
    main()
