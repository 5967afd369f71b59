"""What differs between two files of answers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

TOLERANCE = 1e-9  # relative for numbers above 1, absolute below [1, or the unit of the number]
IGNORED = {  # keys that are not compared, wherever they stand, and why
    "version": "of the package",
    "command": "the line as typed, with paths",
    "sha256": "of a log; the runner compares its own",
    "source": "file name or description of a run",
    "log": "path",
    "urdf": "path",
    "message": "sentence for people",
    "advice": "sentence for people",
    "reason": "sentence for people",
    "sentence": "sentence for people",
    "notes": "sentences for people",
    "warnings": "sentences for people",
    "motion": "sentence for people: the motion that would tell",
    "settings": "names of settings may move; their effect shows in the numbers",
}
IGNORED_TEXTS = {"velocity": "sentence for people in a record"}  # keys whose strings alone are not compared


def differences(a: dict[str, Any], b: dict[str, Any]) -> dict[str, list[str]]:
    """Return what differs, by case; a case that one of the files lacks differs too.

    Raises:
        ValueError: If the two were not run on the same logs.
    """
    if other := [f for f in a["logs"].keys() & b["logs"].keys() if a["logs"][f] != b["logs"][f]]:
        raise ValueError(f"the answers are of other logs: {', '.join(sorted(other))}")
    out = {}
    for case in dict.fromkeys([*a["cases"], *b["cases"]]):
        if not (case in a["cases"] and case in b["cases"]):
            out[case] = [f"only in {'the first' if case in a['cases'] else 'the second'}"]
            continue
        one, two = ({k: side["cases"][case].get(k) for k in ("exit", "files")} for side in (a, b))
        if found := list(_between(one, two, "")):
            out[case] = found
    return out


def _between(a: Any, b: Any, where: str) -> Iterator[str]:
    if _is_number(a) and _is_number(b):
        if not _same(a, b):
            yield f"{where}: {a!r} → {b!r} ({_off(a, b)})"
    elif isinstance(a, dict) and isinstance(b, dict):
        for key in dict.fromkeys([*a, *b]):
            if key in IGNORED or (key in IGNORED_TEXTS and isinstance(a.get(key), str)):
                continue
            at = f"{where}/{key}"
            if key in a and key in b:
                yield from _between(a[key], b[key], at)
            else:
                yield f"{at}: only in {'the first' if key in a else 'the second'}"
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            yield f"{where}: {len(a)} → {len(b)} entries"
        for k, (x, y) in enumerate(zip(a, b, strict=False)):
            yield from _between(x, y, f"{where}[{k}]")
    elif a != b or type(a) is not type(b):
        yield f"{where}: {a!r} → {b!r}"


def _is_number(x: Any) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool)


def _same(a: float, b: float) -> bool:
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) and math.isnan(b)
    return a == b or abs(a - b) <= TOLERANCE * max(1.0, abs(a), abs(b))


def _off(a: float, b: float) -> str:
    return f"{abs(a - b) / max(abs(a), abs(b)):.1e} of it"
