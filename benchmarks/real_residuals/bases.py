"""What `discover` finds in untouched logs, kept once for all cases that need it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from time import process_time
from typing import ClassVar

from benchmarks.outcomes import JsonLine
from benchmarks.real_residuals.answers import Named, of_discovery
from benchmarks.real_residuals.cases import ALONE, MODEL, Case
from benchmarks.real_residuals.failures import failed
from benchmarks.real_residuals.pairs import repeated, single_recordings
from benchmarks.real_residuals.recordings import Recording
from benchmarks.real_residuals.variants import Variant, varied
from cdia_pin import Dynamics, discover, load_model, save_model
from cdia_pin.discovery import Discovery
from cdia_pin.regression.shares import mean_share
from cdia_pin.robot import RobotModel


@dataclass(frozen=True)
class BaseCase:
    """A log to be asked what its arm's URDF lacks.

    Attributes:
        recording: The log.
        variant: What is done to it before.
    """

    recording: Recording
    variant: Variant = Variant.NONE

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return self.plain + (f"/{self.variant}" if self.variant else "")

    @property
    def plain(self) -> str:
        """Name of the log as it was measured."""
        return self.recording.id


@dataclass(frozen=True)
class Base(JsonLine):
    """What was found in an untouched log.

    Attributes:
        id: Of the log and the variant.
        plain: Of the log as it was measured.
        arm: Name of the arm.
        whole: Whether the log is whole and as it was measured.
        named: Effects that count as named.
        verdict: In the program's word.
        heldout: Error on blocks that were not fitted over that of the URDF, mean over the joints [1].
        model: Text of the model file; empty if the program failed.
        seconds: Processor time [s].
        failure: What the program failed with; empty if it did not.
    """

    id: str
    plain: str
    arm: str
    whole: bool
    named: tuple[Named, ...] = ()
    verdict: str = ""
    heldout: float = nan
    model: str = ""
    seconds: float = nan
    failure: str = ""

    def load(self, robot: RobotModel) -> Dynamics:
        """Return the model, as a later command would load it from its file.

        Args:
            robot: The arm.
        """
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.json"
            path.write_text(self.model, encoding="utf-8")
            return load_model(path, robot)

    READ: ClassVar = {"named": lambda v: tuple(map(Named.from_dict, v))}


def needed(cases: Iterable[Case]) -> list[BaseCase]:
    """Return the logs that some cases need a discovery of, each once."""
    wanted = [c.pair.before for c in cases if c.flow == MODEL]
    wanted += [c.pair.after for c in cases if c.flow == ALONE]
    return [BaseCase(r) for r in dict.fromkeys(wanted)]


def planned_bases() -> list[BaseCase]:
    """Return the logs that are asked for their own sake: whole ones, their variants, and those of repeatability."""
    whole = [BaseCase(r, v) for r in single_recordings() for v in Variant]
    return list(dict.fromkeys([*whole, *(BaseCase(r) for two in repeated() for r in two)]))


def run_base(case: BaseCase) -> Base:
    """Ask what the URDF lacks."""
    recording = case.recording
    whole = recording in single_recordings() and case.variant is Variant.NONE
    base, robot, began = Base(case.id, case.plain, recording.arm, whole), recording.robot, process_time()
    try:
        log = varied(recording.read(), case.variant)
        began = process_time()
        found = discover(Dynamics(robot), log)
    except BaseException as why:  # a solver may panic, which is no Exception
        return replace(base, failure=failed(why), seconds=process_time() - began)
    return replace(
        base,
        named=of_discovery(found),
        verdict=found.verdict,
        heldout=_heldout(found),
        seconds=process_time() - began,
        model=_text(found),
    )


def _heldout(found: Discovery) -> float:
    first, last = (found.trace[k].heldout_rms for k in (0, -1))
    return mean_share(last, first)


def _text(found: Discovery) -> str:
    with tempfile.TemporaryDirectory() as folder:
        return save_model(found.model, Path(folder) / "model.json").read_text(encoding="utf-8")
