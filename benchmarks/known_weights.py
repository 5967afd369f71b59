"""Weigh what is on a UR10e once `cdia calibrate` has seen a known weight, and write docs/results-known-weights.md.

Usage:
    python -m benchmarks.known_weights

The measured 2.6 kg calibrate the drive gains, beside both logs without a load. Then a weight is put into the loaded
log, or taken out of it, by the torque of the rigid bodies with and without it, and `compare` weighs the whole.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.claim_tables import MUST_SHOW
from benchmarks.claims import Figure, at_least, at_most, counted
from benchmarks.markdown import Row, table
from benchmarks.measured_logs import folder
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import made_by, publish
from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.judging import row
from benchmarks.real_residuals.recordings import ARMS, robot_of
from cdia_pin import Dynamics, Log, read_log, what_changed
from cdia_pin.effects import Payload, Term
from cdia_pin.identification import calibrate_gains
from cdia_pin.logs.gains import Gains, read_gains
from cdia_pin.robot import RobotModel
from cdia_pin.viewers.words import number, percent

ARM, LOADED, UNLOADED = "ur10e", "loaded_2600g", ("fourier_50s", "fourier_40s")
KNOWN = 2.6  # [kg], on the flange in the loaded log
MORE = (
    -1.3,
    0.0,
    1.3,
    2.6,
    5.2,
)  # [kg], put into that log besides, at the centre of mass of the known weight
WANTED = 0.03  # [1], error of a weight
PAGE = CHECKOUT / "docs" / "results-known-weights.md"


@dataclass(frozen=True)
class Weighing:
    """A weight that was found.

    Attributes:
        gains: Which drive gains: nominal, or calibrated.
        unloaded: Log without the weight.
        mass: What is on the flange [kg].
        found: Mass of the payload that was named [kg]; NaN if none was.
        half: Half width of its 95 % interval [kg].
    """

    gains: str
    unloaded: str
    mass: float
    found: float = np.nan
    half: float = np.nan

    @property
    def error(self) -> float:
        """Error over the mass [1]; infinite if no payload was named."""
        return abs(self.found / self.mass - 1.0) if np.isfinite(self.found) else np.inf


def main() -> None:
    """Weigh, and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.known_weights", description="Weigh known weights after a calibration."
    )
    folder.add_option(given)
    given.add_argument("--out", type=Path, default=PAGE, help="page to write")
    options = given.parse_args()
    if not folder.are_there(options.data):
        tell("measured logs: not there, skipped")
        return
    os.environ[folder.VARIABLE] = str(options.data)
    publish(page(list(weighings(options.data))), options.out)


def weighings(data: Path) -> Iterator[Weighing]:
    """Yield what is found of each weight, by nominal and by calibrated gains.

    Args:
        data: Folder of the measured logs.
    """
    robot, nominal = robot_of(ARM), data / ARMS[ARM].gains

    def read(file: str, gains: Gains) -> Log:
        return read_log(data / ARM / f"{file}.csv", robot, gains=gains)

    empty = [read(file, nominal) for file in UNLOADED]
    calibration = calibrate_gains(robot, [read(LOADED, nominal)], empty, KNOWN)
    calibrated: Gains = calibration.gains(read_gains(nominal, robot.joints).value)
    for word, gains in (("nominal", nominal), ("calibrated", calibrated)):
        loaded, without = read(LOADED, gains), {file: read(file, gains) for file in UNLOADED}
        along = FilteredLog.of(loaded, robot)
        for more in MORE:
            body = np.zeros(Payload().size)
            body[:4] = more, *(more * calibration.centre)
            heavier = Insertion(Term(Payload(), tuple(body)), along).into(loaded) if more else loaded
            for file, log in without.items():
                yield _weighed(Weighing(word, file, KNOWN + more), robot, log, heavier)


def _weighed(asked: Weighing, robot: RobotModel, empty: Log, loaded: Log) -> Weighing:
    changes = what_changed(Dynamics(robot), empty, loaded).changes
    payload = next((c.term for c in changes if isinstance(c.term.effect, Payload)), None)
    found = (payload.values["mass"], float(payload.half_widths[0])) if payload else (np.nan, np.nan)
    tell(f"{asked.gains} gains, {asked.unloaded}: {asked.mass:.1f} kg, found {found[0]:.2f} kg")
    return Weighing(asked.gains, asked.unloaded, asked.mass, *found)


def page(found: list[Weighing]) -> str:
    """Return the page as Markdown.

    Args:
        found: Every weighing.
    """
    calibrated = [w for w in found if w.gains == "calibrated" and w.mass != KNOWN]
    near, held = (
        counted([w.error <= WANTED for w in calibrated]),
        counted([abs(w.found - w.mass) <= w.half for w in calibrated]),
    )
    middle, worst = float(np.median([w.error for w in calibrated])), max(calibrated, key=lambda w: w.error)
    rows = [
        row("other weights: within 3 %", "all", near, at_least(1.0)),
        row(
            "other weights: error, median",
            "≤ 3 %",
            Figure(middle, len(calibrated), percent(middle)),
            at_most(WANTED),
        ),
        row(
            "other weights: error, largest",
            "≤ 3 %",
            Figure(worst.error, len(calibrated), f"{percent(worst.error)}, of {worst.mass:.1f} kg"),
            at_most(WANTED),
        ),
        row("other weights: inside their 95 % interval", "≥ 90 %", held, at_least(0.9)),
    ]
    heads = ("gains", "log without it", "on the flange", "found", "error")
    return "\n\n".join([
        "# Weights after a calibration",
        made_by("python -m benchmarks.known_weights", ("pin", "numpy", "scipy")),
        f"`cdia calibrate --known-payload {KNOWN}` sees the measured weight of a UR10e, beside both logs without it. "
        "Other weights are then put into the loaded log, or taken out of it, at the centre of mass of the known one: "
        "the torque of the rigid bodies with and without them, by the same gains. `cdia compare` weighs the whole "
        "against each log without a load.",
        "## Must show",
        table(MUST_SHOW, rows),
        "## Every weighing",
        table(heads, map(_said, found)),
    ]) + "\n"  # fmt: skip


def _said(w: Weighing) -> Row:
    mass = f"{w.mass:.1f} kg" + (" (measured)" if w.mass == KNOWN else "")
    if not np.isfinite(w.found):
        return (w.gains, w.unloaded, mass, "not named", "–")
    sign = "−" if w.found < w.mass else "+"
    return (
        w.gains,
        w.unloaded,
        mass,
        f"{number(w.found, 3)} ± {number(w.half, 2)} kg",
        f"{sign}{percent(w.error)}",
    )


if __name__ == "__main__":
    main()
