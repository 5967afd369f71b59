"""A fuzzer that is led by coverage: it keeps inputs that reach new code, and changes those further.

    python -m tests.fuzzing.guided                     # every kind, the same inputs in each run
    python -m tests.fuzzing.guided logs --seconds 600  # new inputs

It needs `atheris` (``pip install "cdia-pin[fuzz]"``). What breaks is kept in out/fuzz; put it into the corpus beside
the mend.
"""

from __future__ import annotations

import argparse
import importlib
import logging
import pkgutil
import re
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"
KINDS = sorted(folder.name for folder in CORPUS.iterdir())
# their modules are imported at once; where they are needed is too late for the fuzzer to follow them
PACKAGES = ("logs", "robot", "dynamics", "effects", "diagnosis", "fleet", "campaigns")
ROOT = Path(__file__).parents[2]


def modules_of(package: str, saying: str = "") -> list[str]:
    """Return the full names of a package's modules in which a line begins with a text."""
    return [
        ".".join(file.relative_to(ROOT).with_suffix("").parts)
        for file in sorted((ROOT / "cdia_pin" / package).rglob("*.py"))
        if re.search(rf"^{saying}", file.read_text(encoding="utf-8"), re.MULTILINE)
    ]


# by numba, which takes no code that the fuzzer has changed; a monitor compiles the effects too
COMPILED = modules_of("diagnosis", "@njit")
COMPILED_TOO = {kind: modules_of("effects") for kind in ("samples", "monitors")}
OUT = ROOT / "out" / "fuzz"
# of each kind in a run that is the same each time; half a minute for samples, which are the slowest
INPUTS = 1500
SLOWEST = 20  # [s] for one input; a reader that takes longer hangs
MOST_MEMORY = 3000  # [MB]


def fuzz(kind: str, seconds: int | None) -> None:
    """Fuzz one kind in this process, which the fuzzer ends: with 0 if nothing broke.

    It tries new inputs for some seconds, or the same `INPUTS` each time.
    """
    import atheris

    warnings.simplefilter("ignore")
    logging.disable()
    with atheris.instrument_imports(include=["cdia_pin"], exclude=[*COMPILED, *COMPILED_TOO.get(kind, [])]):
        from tests.fuzzing.readers import READERS, CdiaError

        for package in PACKAGES:
            whole = importlib.import_module(f"cdia_pin.{package}")
            for module in pkgutil.walk_packages(whole.__path__, f"{whole.__name__}."):
                importlib.import_module(module.name)
    read, seeds = READERS[kind], CORPUS / kind
    suffixes = sorted({file.suffix for file in seeds.iterdir()})
    folder = Path(tempfile.mkdtemp())

    def one(data: bytes) -> None:
        # the first byte chooses the kind of file, where there are several
        suffix = suffixes[data[0] % len(suffixes)] if data and len(suffixes) > 1 else suffixes[0]
        file = folder / f"fuzzed{suffix}"
        file.write_bytes(data[1:] if len(suffixes) > 1 else data)
        try:
            read(file)
        except CdiaError as error:
            assert str(error).strip()
        except BaseException:
            file.replace(OUT / f"broke_{kind}{suffix}")
            raise

    first = folder / "seeds"
    first.mkdir()
    for file in seeds.iterdir():
        chosen = bytes([suffixes.index(file.suffix)]) if len(suffixes) > 1 else b""
        (first / file.name).write_bytes(chosen + file.read_bytes())
    OUT.mkdir(parents=True, exist_ok=True)
    amount = [f"-runs={INPUTS}", "-seed=1"] if seconds is None else [f"-max_total_time={seconds}"]
    limits = [*amount, f"-timeout={SLOWEST}", f"-rss_limit_mb={MOST_MEMORY}"]
    atheris.Setup([sys.argv[0], *limits, f"-artifact_prefix={OUT}/{kind}-", str(first)], one)
    atheris.Fuzz()


def _in_short(said: str) -> str:
    """Return how many inputs were tried, and how many branches they reached at the start and at the end."""
    reached = re.findall(r"(?:INITED|DONE) +cov: (\d+)", said)
    runs = re.search(r"Done (\d+) runs", said)
    if runs is None or len(reached) < 2:
        return "broke"
    return f"{runs[1]} inputs, {reached[0]} branches reached by the corpus, {reached[-1]} in the end"


def main() -> int:
    """Fuzz each kind in a process of its own; return 1 if something broke."""
    given = argparse.ArgumentParser(
        prog="python -m tests.fuzzing.guided", description="Fuzz what reads files."
    )
    given.add_argument("kinds", nargs="*", choices=[[], *KINDS], default=[], help="all by default")
    given.add_argument(
        "--seconds",
        type=int,
        help=f"try new inputs of each kind for so long [s]; else the same {INPUTS:,} each time",
    )
    given.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    options = given.parse_args()
    if options.here:
        fuzz(options.kinds[0], options.seconds)
        return 0
    broke = []
    for kind in options.kinds or KINDS:
        command = [sys.executable, "-m", "tests.fuzzing.guided", kind, "--here"]
        if options.seconds is not None:
            command += ["--seconds", str(options.seconds)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        print(f"{kind}: {_in_short(done.stderr)}", flush=True)
        if done.returncode:
            broke.append(kind)
            print(done.stdout[-3000:], done.stderr[-3000:], sep="\n")
    if broke:
        print(f"broke: {', '.join(broke)}; the inputs are in {OUT}")
    return 1 if broke else 0


if __name__ == "__main__":
    sys.exit(main())
