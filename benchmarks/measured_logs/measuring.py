"""A case measured: the URDF, each effect that is discovered, least squares, the full identification, and figaroh."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measured_logs.cases import Case
from benchmarks.measured_logs.errors import Bench, Column
from benchmarks.measured_logs.least_squares import least_squares
from benchmarks.measured_logs.process import cdia
from benchmarks.peers.figaroh_process import AbsentError, figaroh
from cdia_pin import DiscoverySettings, Dynamics, discover, load_model, write_log

CUTOFFS = (10.0, 5.0)  # [Hz]: the data's README filtered at 5 to 10 Hz; the first one is looked at closely
IDENTIFY = "cdia identify"
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Measured:
    """A case at one cut-off.

    Attributes:
        bench: The filtered logs.
        columns: Ways of fitting, from the URDF to the full identification.
        steps: The effects that `discover` adds, in its order; empty where it was not run.
        absent: Why figaroh did not take part; empty if it did.
    """

    bench: Bench
    columns: tuple[Column, ...]
    steps: tuple[Column, ...] = ()
    absent: str = ""

    @property
    def columns_by_name(self) -> dict[str, Column]:
        """Ways of fitting by name."""
        return {c.name: c for c in self.columns}


def measure(case: Case, cutoff: float, python: str, tell: Tell) -> Measured:
    """Measure a case.

    Args:
        case: The logs.
        cutoff: Of the filter [Hz].
        python: Interpreter of an environment that has figaroh.
        tell: Called with what was done.
    """
    bench = Bench.of(case, cutoff)
    bare = Dynamics(case.robot)
    columns = [bench.column("URDF", bare), least_squares(bench)]
    columns += [_identify(bench, "plain laws", "--plain"), _identify(bench, "")]
    tell(f"{columns[-1].seconds:5.1f} s  cdia identify, {case.name}, {cutoff:g} Hz")
    if cutoff != CUTOFFS[0]:
        return Measured(bench, tuple(columns))
    found = discover(
        bare, case.fitted, holdout=case.unseen, settings=DiscoverySettings(conditioning=bench.conditioning)
    )
    steps = [bench.step(s.term.label if s.term else "URDF", s.heldout_rms) for s in found.trace]
    columns.insert(1, bench.column("discover", found.model))
    tell(f"         discover: {len(found.steps)} effects")
    absent = ""
    try:
        columns += figaroh(bench, python)
        tell(f"{columns[-1].seconds:5.1f} s  figaroh")
    except AbsentError as error:
        absent = str(error)
        tell(f"         figaroh: {absent}")
    return Measured(bench, tuple(columns), tuple(steps), absent)


def _identify(bench: Bench, kind: str, *options: str) -> Column:
    """Return what ``cdia identify`` gives, run in a process of its own as a user would run it."""
    case = bench.case
    with tempfile.TemporaryDirectory() as folder:
        log, model = Path(folder) / "fitted.csv", Path(folder) / "model.json"
        write_log(case.fitted, log)
        given = [
            str(log),
            "--robot",
            case.described,
            "--no-check",
            "--cutoff",
            str(bench.conditioning.cutoff),
        ]
        done, seconds = cdia("identify", *given, "--save", str(model), *options)
        done.check_returncode()
        return bench.column(", ".join(filter(None, (IDENTIFY, kind))), load_model(model, case.robot), seconds)
