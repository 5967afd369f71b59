"""Run the golden cases with the `cdia_pin` that Python imports, and keep what it writes.

    PYTHONPATH=OTHER_CHECKOUT python benchmarks/golden/run.py OUT.json --logs .cache/golden --data ../shared/data

The file needs nothing but the standard library and the command line `python -m cdia_pin`, so it runs older states of
the package too. Each case is a forked process in a folder of its own. The answers are raw: what may differ is for
`compare` to say.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import fnmatch
import hashlib
import importlib
import json
import math
import os
import re
import runpy
import shlex
import sys
import tempfile
import tomllib
import traceback
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

HERE = Path(__file__).resolve().parent
CASES = HERE / "cases.toml"
MEASURED = ("check", "compare", "discover")  # asked of every measured log
PRELOADED = (
    "numpy",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.signal",
    "pinocchio",
    "clarabel",
    "typer",
    "rich",
)
SAMPLES = 20  # rows kept of a long table
KEPT = "answer.of_case.json"  # file by which a case hands over what it wrote
Say = Callable[[str], None]


@dataclass(frozen=True)
class Case:
    """One or more command lines that run after each other in one folder.

    Attributes:
        id: Readable name.
        lines: What follows `cdia`; `{logs}` and `{data}` stand for the folders.
        quick: Whether it belongs to the quick set.
    """

    id: str
    lines: tuple[str, ...]
    quick: bool


def read_cases(file: Path = CASES) -> list[Case]:
    """Return all cases, seeded ones first."""
    text = tomllib.loads(file.read_text(encoding="utf-8"))
    quick = set(text.pop("quick"))
    measured = text.pop("measured_logs")
    lines = {
        id_: [given] if isinstance(given, str) else given
        for part in text.values()
        for id_, given in part.items()
    }
    for log, options in measured.items():
        lines |= {
            f"measured/{log}/{command}": [f"{command} {{data}}/{log} {options}"] for command in MEASURED
        }
    if unknown := quick - set(lines):
        raise SystemExit(f"{file}: no such quick cases: {', '.join(sorted(unknown))}")
    return [Case(id_, tuple(given), id_ in quick) for id_, given in lines.items()]


def selected(cases: list[Case], only: str = "*", quick: bool = False) -> list[Case]:
    """Return the cases that match a pattern, which may be a part of the id."""
    return [c for c in cases if (c.quick or not quick) and (only in c.id or fnmatch.fnmatch(c.id, only))]


def run(cases: list[Case], logs: Path, data: Path, jobs: int = 1, say: Say = print) -> dict[str, Any]:
    """Run cases, so many at a time, and return their answers.

    Args:
        cases: What to run; those whose logs are not there are skipped, and said so.
        logs: Folder of the seeded logs.
        data: Folder of the measured logs.
        jobs: Processes at a time.
        say: Takes a line about each case.
    """
    package = _preload()
    began, waiting = perf_counter(), list(cases)
    running: dict[int, tuple[Case, Path, float]] = {}  # by the number of the process; since when
    answers: dict[str, dict[str, Any]] = {}
    files: dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="golden-") as folder:
        while waiting or running:
            while waiting and len(running) < jobs:
                case = waiting.pop(0)
                commands = [_arguments(line, logs, data) for line in case.lines]
                needed = _inputs(commands, logs, data)
                if absent := [str(f) for f in needed if not f.exists()]:
                    say(f"skipped  {case.id}: no {', '.join(absent)}")
                    answers[case.id] = {"skipped": True}
                    continue
                files |= {
                    f.name if f.is_relative_to(logs) else str(f.relative_to(data)): _sha256(f) for f in needed
                }
                out = Path(folder) / re.sub(r"\W+", "_", case.id)
                out.mkdir()
                running[_started(commands, out)] = case, out, perf_counter()
            if not running:
                continue
            pid, status, usage = os.wait4(-1, 0)
            case, out, since = running.pop(pid)
            answers[case.id] = answer = _kept(out, status)
            answer |= {"processor_s": usage.ru_utime + usage.ru_stime, "wall_s": perf_counter() - since}
            say(f"{answer['processor_s']:6.1f} s  {case.id}: exit {answer['exit']}")
    order = [c.id for c in cases]
    return {
        "package": package,
        "total_s": perf_counter() - began,
        "logs": dict(sorted(files.items())),
        "cases": {id_: answers[id_] for id_ in order},
    }


def _preload() -> str:
    """Import what every case needs, before the processes part; return where the package is."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for name in PRELOADED:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    return str(Path(str(importlib.import_module("cdia_pin").__file__)).parent)


def _arguments(line: str, logs: Path, data: Path) -> list[str]:
    return [part.replace("{logs}", str(logs)).replace("{data}", str(data)) for part in shlex.split(line)]


def _inputs(commands: list[list[str]], logs: Path, data: Path) -> list[Path]:
    """Return the files below the folders of logs that commands name, also behind `NAME=`."""
    parts = {re.sub(r"^\w+=", "", p) for command in commands for part in command for p in part.split(",")}
    return sorted(f for f in map(Path, parts) if f.is_relative_to(logs) or f.is_relative_to(data))


def _started(commands: list[list[str]], out: Path) -> int:
    """Fork a process that runs the commands, and return its number."""
    sys.stdout.flush()
    sys.stderr.flush()
    if pid := os.fork():
        return pid
    try:
        os.chdir(out)
        with (out / "said.txt").open("w", encoding="utf-8") as said:
            os.dup2(said.fileno(), 1)
            os.dup2(said.fileno(), 2)
        exits = []
        for number, command in enumerate(commands, 1):
            exits.append(_exit_of(command, number))
            if exits[-1]:
                break
        (out / KEPT).write_text(json.dumps({"exit": exits, "files": _files(out) if not exits[-1] else {}}))
    except BaseException:
        traceback.print_exc()
        os._exit(70)
    os._exit(0)


def _exit_of(command: list[str], number: int) -> int:
    """Run one command in this process as `python -m cdia_pin` would, and return its exit code."""
    sys.argv = ["cdia", *command, "--json", f"{number}_{command[0]}.json"]
    try:
        runpy.run_module("cdia_pin", run_name="__main__", alter_sys=True)
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:  # also the panic of a compiled library
        traceback.print_exc()
        return 1
    return 0


def _kept(out: Path, status: int) -> dict[str, Any]:
    """Return what a process handed over; its exit code alone if it failed."""
    code = os.waitstatus_to_exitcode(status)
    if code or not (out / KEPT).exists():
        return {"exit": [code], "files": {}, "said": _end_of(out)}
    answer: dict[str, Any] = json.loads((out / KEPT).read_text())
    return answer if not answer["exit"][-1] else answer | {"said": _end_of(out)}


def _end_of(out: Path) -> str:
    return (out / "said.txt").read_text(encoding="utf-8", errors="replace")[-400:]


def _files(out: Path) -> dict[str, Any]:
    """Return the contents of all JSON, table and URDF files of a folder, by name."""
    readers = {
        ".json": lambda f: json.loads(f.read_text(encoding="utf-8")),
        ".csv": table,
        ".urdf": urdf_numbers,
    }
    found = (f for f in sorted(out.iterdir()) if f.suffix in readers and f.name != KEPT)
    return {f.name: readers[f.suffix](f) for f in found}


def table(file: Path) -> dict[str, Any]:
    """Return the columns of a table: length, RMS and a sample of the rows."""
    with file.open(newline="", encoding="utf-8") as lines:
        heading, *rows = csv.reader(lines)
    columns = {name: [float(row[k]) for row in rows] for k, name in enumerate(heading)}
    every = max(1, len(rows) // SAMPLES)
    return {
        name: {
            "count": len(x),
            "rms": math.sqrt(math.fsum(v * v for v in x) / max(len(x), 1)),
            "sample": x[::every],
        }
        for name, x in columns.items()
    }


def urdf_numbers(file: Path) -> dict[str, list[float]]:
    """Return all masses, inertias, centres of mass, damping and friction of a URDF, by link or joint."""
    return {name: list(numbers) for name, numbers in _urdf_rows(ET.parse(file).getroot())}


def _urdf_rows(root: ET.Element) -> Iterator[tuple[str, list[float]]]:
    for link in root.iter("link"):
        parts = [link.find(f"inertial/{tag}") for tag in ("mass", "origin", "inertia")]
        yield f"link {link.get('name')}", [x for p in parts if p is not None for x in _floats(p)]
    for joint in root.iter("joint"):
        for dynamics in joint.findall("dynamics"):
            yield f"joint {joint.get('name')}", _floats(dynamics)


def _floats(element: ET.Element) -> list[float]:
    return [float(x) for name in sorted(element.attrib) for x in element.attrib[name].split()]


def _sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def main(arguments: list[str] | None = None) -> None:
    """Run the cases and write the answers."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("out", type=Path, help="file of answers to write")
    parser.add_argument("--logs", type=Path, required=True, help="folder of the seeded logs")
    parser.add_argument("--data", type=Path, required=True, help="folder of the measured logs")
    parser.add_argument("--cases", type=Path, default=CASES, help="file of cases")
    parser.add_argument("--only", default="", help="ids that match, or have this part")
    parser.add_argument("--quick", action="store_true", help="a dozen cases, below a minute")
    parser.add_argument("--jobs", type=int, default=1, help="cases at a time")
    given = parser.parse_args(arguments)
    cases = selected(read_cases(given.cases), given.only, given.quick)
    answers = run(cases, given.logs.resolve(), given.data.resolve(), given.jobs)
    draft = given.out.with_name(f"{given.out.name}.part")  # the old answers stay until the new ones are whole
    draft.write_text(json.dumps(answers, indent=1), encoding="utf-8")
    draft.replace(given.out)
    processor = sum(a.get("processor_s", 0.0) for a in answers["cases"].values())
    print(
        f"{len(cases)} cases, {processor:.0f} s of processor, {answers['total_s']:.0f} s, with {answers['package']}"
    )


if __name__ == "__main__":
    sys.path.remove(str(HERE))  # the package's own folders come first, and nothing of this one
    main()
