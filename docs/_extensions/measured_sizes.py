"""The sizes that effects have on measured arms, read from the tables that a benchmark wrote."""

from __future__ import annotations

import re
from collections import defaultdict
from functools import cache
from itertools import islice
from pathlib import Path

MOST = 4  # parameters of an effect [1] that are told
PAGE = Path(__file__).resolve().parents[1] / "results.md"
ARM = re.compile(r"^\*\*(\w+)\*\* \(")
ROW = re.compile(r"^\| ([a-z ]+) \| [^|]+ \| ([^|]+) \|")
VALUE = re.compile(r"([a-z ]+?)(?:\[\w+\])? (−?[\d.]+)\s±\s([\d.]+)(?:\s(\S+))?$")


@cache
def sizes() -> dict[str, dict[tuple[str, str], dict[str, list[float]]]]:
    """Return the values whose interval leaves out zero: by effect, by parameter and unit, and by arm."""
    found: dict[str, dict[tuple[str, str], dict[str, list[float]]]] = {}
    arm = ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if head := ARM.match(line):
            arm = head[1]
        elif arm and (row := ROW.match(line)):
            by_parameter = found.setdefault(row[1].replace(" ", "_"), defaultdict(lambda: defaultdict(list)))
            for text in row[2].split("; "):
                if said := VALUE.match(text.strip()):
                    value, half = float(said[2].replace("−", "-")), float(said[3])
                    if abs(value) > half:
                        by_parameter[said[1], said[4] or ""][arm].append(value)
    return found


def sentence(effect: str) -> str:
    """Return the range of each parameter on measured arms in words; empty where none was found.

    Args:
        effect: Its name.
    """
    said = []
    for (parameter, unit), by_arm in islice(sizes().get(effect, {}).items(), MOST):
        values = sorted(value for found in by_arm.values() for value in found)
        numbers = " to ".join(
            f"{value:g}".replace("-", "−") for value in dict.fromkeys((values[0], values[-1]))
        )
        said.append(f"{parameter} {numbers} {unit}".rstrip() + f" ({', '.join(sorted(by_arm))})")
    return "; ".join(said)
