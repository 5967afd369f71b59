"""Let a monitor run for ten million ticks, and write docs/results-soak.md: does it grow, slow down, or lose its sight?

Usage:
    python -m benchmarks.soak                      # some ten minutes
    python -m benchmarks.soak --ticks 100000

An arm of seven joints repeats a motion. Dry friction comes, is isolated and compensated, and goes, again and again; now
and then a sample is not a number. Rigid bodies give the torques: this is about memory and time, not about finding
faults.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.claim_tables import MUST_SHOW
from benchmarks.claims import met
from benchmarks.markdown import table
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import made_by, publish, stated
from cdia_pin import Dynamics, Log
from cdia_pin.diagnosis import Monitor
from cdia_pin.effects import parse_term
from cdia_pin.robot import load_robot

PAGE = CHECKOUT / "docs" / "results-soak.md"
ARM, FAULT = "panda", "coulomb_friction@panda_joint4: level=4"
RATE, PERIOD = 1000.0, 10.0  # [Hz], [s] of the motion
ON = 3  # periods with the fault, then as many without
NOISE = 0.02  # [N·m], standard deviation of the torque's
BAD_EVERY = 77_777  # ticks between two samples that are not a number
PARTS = 10  # of the run that are compared
MOST_GROWTH = 1.05  # [1], of memory, from the second part to the largest


@dataclass(frozen=True)
class Part:
    """What one part of the run showed.

    Attributes:
        microseconds: Processor time of a tick [µs].
        memory: Of the process [MB].
        faults: How often the fault was there.
        seen: How often it alone was believed, at its end.
        cleared: How often nothing was believed, at the end of the time without it.
        finite: Whether every residual and every torque to command was a number.
    """

    microseconds: float
    memory: float
    faults: int
    seen: int
    cleared: int
    finite: bool


def motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return positions, velocities and accelerations of a period, shape (N, n) each."""
    robot = load_robot(ARM)
    t = np.arange(0.0, PERIOD, 1.0 / RATE)[:, None]
    rng = np.random.default_rng(0)
    w = 2 * np.pi / PERIOD * np.arange(1, 4)[:, None, None]
    size, phase = rng.uniform(0.05, 0.3, (3, 1, robot.n)), rng.uniform(0, 2 * np.pi, (3, 1, robot.n))
    middle = (robot.limits.lower + robot.limits.upper) / 2
    q = middle + (size * np.sin(w * t + phase)).sum(axis=0)
    v = (size * w * np.cos(w * t + phase)).sum(axis=0)
    return q, v, -(size * w**2 * np.sin(w * t + phase)).sum(axis=0)


def run(ticks: int) -> list[Part]:
    """Run the monitor."""
    model = Dynamics(load_robot(ARM))
    q, v, a = motion()
    rng = np.random.default_rng(1)
    well = model.inverse_dynamics(q, v, a) + rng.normal(0.0, NOISE, q.shape)
    ill = model.add(parse_term(FAULT)).inverse_dynamics(q, v, a) + rng.normal(0.0, NOISE, q.shape)
    t = np.arange(3 * len(q)) / RATE
    healthy = Log(
        model.robot.joints, t, *(np.tile(x, (3, 1)) for x in (q, well)), velocity=np.tile(v, (3, 1))
    )
    monitor = Monitor(model, healthy=[healthy])
    parts, size = [], ticks // PARTS
    for part in range(PARTS):
        began, faults, seen, cleared, finite = process_time(), 0, 0, 0, True
        for k in range(part * size, (part + 1) * size):
            period, i = divmod(k, len(q))
            has_fault = (period // ON) % 2 == 1
            position = q[i] * np.nan if k % BAD_EVERY == BAD_EVERY - 1 else q[i]
            status = monitor.update(k / RATE, position, v[i], (ill if has_fault else well)[i])
            command = monitor.correct(well[i], v[i])
            finite &= bool(np.isfinite(command).all() and np.isfinite(status.residual).all())
            if i == len(q) - 1 and period % ON == ON - 1:
                named = {t.label for t in monitor.faults}
                faults += has_fault
                seen += has_fault and named == {FAULT.partition(":")[0]}
                cleared += not has_fault and not named
        parts.append(Part(1e6 * (process_time() - began) / size, _memory(), faults, seen, cleared, finite))
        tell(f"{part + 1} of {PARTS}: {parts[-1]}")
    return parts


def _memory() -> float:
    """Return the memory that this process has in use now [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096 / 1e6


def page(parts: Sequence[Part], ticks: int, command: str) -> str:
    """Return the page."""
    # the first part compiles and fills what is bounded
    memory, time = (max(x[2:]) / x[1] for x in ([p.memory for p in parts], [p.microseconds for p in parts]))
    faults, seen = sum(p.faults for p in parts), sum(p.seen for p in parts)
    finite = all(p.finite for p in parts)

    rows = [
        ("ticks", "10⁷", f"{ticks:,}", PARTS, met(ticks >= 10_000_000)),
        (
            "largest memory over that of the second part",
            f"≤ {MOST_GROWTH}",
            f"{memory:.3f}",
            PARTS,
            met(memory <= MOST_GROWTH),
        ),
        ("slowest part over the second one", "–", f"{time:.2f}", PARTS, "–"),
        ("faults that are believed, alone and by their name", "all", str(seen), faults, met(seen == faults)),
        ("all finite", "all", str(finite), PARTS, met(finite)),
    ]
    heads = ("part", "µs per tick", "memory, MB", "faults", "believed", "cleared")
    each = [
        (k + 1, f"{p.microseconds:.1f}", f"{p.memory:.1f}", p.faults, p.seen, p.cleared)
        for k, p in enumerate(parts)
    ]
    return (
        "\n\n".join(
            (
                "# A monitor that does not stop",
                made_by(command, ("pin", "numba", "numpy")),
                str(__doc__).split("\n\n")[2].strip().replace("\n", " "),
                table(MUST_SHOW, rows),
                table(heads, each),
            )
        )
        + "\n"
    )


def main() -> None:
    """Run the monitor and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.soak", description="Let a monitor run on and on."
    )
    given.add_argument("--ticks", type=int, default=10_000_000, help="number of ticks")
    given.add_argument(
        "--out", type=Path, help="page to write; by default the one in docs if all ticks are run"
    )
    options = given.parse_args()
    text = page(run(options.ticks), options.ticks, stated(given, options, ("ticks",)))
    publish(text, options.out or (PAGE if options.ticks >= 10_000_000 else None))


if __name__ == "__main__":
    main()
