"""Other tools on some of the cases: time, held-out error and names, beside those of `discover`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from math import inf, nan
from time import perf_counter

import numpy as np

from benchmarks.hidden_effects.case import Case
from benchmarks.hidden_effects.cases import planned
from benchmarks.hidden_effects.drawing import drawn
from benchmarks.hidden_effects.oracle import noise_floor, unordered
from benchmarks.hidden_effects.trial import HELD_OUT
from benchmarks.hidden_effects.truth import label_of, true_model
from benchmarks.peers.answer import Answer
from cdia_pin.discovery import discover
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs import Log
from cdia_pin.robot import RobotModel

TOOLS = {  # tool: module of `benchmarks.peers` with `fit(robot, log)`
    "figaroh": "figaroh_logs",
    "PySINDy": "pysindy_residuals",
    "mujoco.sysid": "mujoco_sysid",
}
OURS, ORACLE, URDF = "cdia discover", "the true model", "the URDF alone"
EFFECTS = (  # that more than one of the tools can have in its model
    "coulomb_friction",
    "viscous_friction",
    "rotor_inertia",
    "payload",
    "joint_spring",
    "position_ripple",
)
OF_EACH = 2  # cases


@dataclass(frozen=True)
class Entry:
    """A tool on a case."""

    tool: str
    case: Case

    @property
    def id(self) -> str:
        """Name of the entry."""
        return f"{self.case.id}/{self.tool}"


@dataclass(frozen=True)
class Score:
    """What came of it.

    Attributes:
        id: Name of the entry.
        tool: The tool.
        effect: What was hidden.
        seconds: Time of the fit [s].
        over_floor: Held-out RMS over the noise floor, RMS over the joints [1].
        exact: Whether it names what is hidden, and nothing else.
        holds: Whether what it names holds what is hidden.
        named: How many effects it names.
        failure: Why there is no result.
    """

    id: str
    tool: str
    effect: str
    seconds: float = nan
    over_floor: float = nan
    exact: bool = False
    holds: bool = False
    named: int = 0
    failure: str = ""

    def to_json(self) -> str:
        """Return the score as a line of JSON; what is not a number as null."""
        return json.dumps(
            {k: None if isinstance(v, float) and not abs(v) < inf else v for k, v in asdict(self).items()}
        )

    @classmethod
    def from_json(cls, line: str) -> Score:
        """Read back what `to_json` wrote."""
        return cls(**{k: nan if v is None else v for k, v in json.loads(line).items()})


def entries() -> list[Entry]:
    """Return the first cases of each effect, by their seeds, with every tool that is here."""
    singles = planned(suites=["single"])
    chosen = [c for e in EFFECTS for c in [c for c in singles if c.effects == (e,)][:OF_EACH]]
    return [Entry(tool, case) for case in chosen for tool in (URDF, ORACLE, OURS, *TOOLS) if _is_here(tool)]


def run_entry(entry: Entry) -> Score:
    """Let a tool fit a case, and predict another motion."""
    plant, scenario = drawn(entry.case)
    true = true_model(plant, scenario.faults)
    assert true is not None
    log, later = (s.run(plant).log for s in (scenario, replace(scenario.holdout(), duration=HELD_OUT)))
    out = Score(entry.id, entry.tool, entry.case.effects[0])
    begin = perf_counter()
    try:
        answer = _fit(entry.tool, true)(plant.robot, log)
    except Exception as why:  # whatever another tool raises is its result
        return replace(out, seconds=perf_counter() - begin, failure=f"{type(why).__name__}: {why}"[:200])
    seconds = perf_counter() - begin
    ratio = answer.error(plant.robot, later) / noise_floor(true, later)
    named, hidden = {unordered(x) for x in answer.named}, {unordered(label_of(f)) for f in scenario.faults}
    return replace(
        out,
        seconds=seconds,
        over_floor=float(np.sqrt(np.mean(ratio**2))),
        exact=named == hidden,
        holds=named >= hidden,
        named=len(named),
    )


def _fit(tool: str, true: Dynamics) -> Callable[[RobotModel, Log], Answer]:
    if tool == OURS:
        return lambda robot, log: _answer(discover(Dynamics(robot), log).model)
    if tool in {ORACLE, URDF}:
        model = true if tool == ORACLE else Dynamics(true.robot)
        return lambda robot, log: _answer(model)
    fit: Callable[[RobotModel, Log], Answer] = import_module(f"benchmarks.peers.{TOOLS[tool]}").fit
    return fit


def _answer(model: Dynamics) -> Answer:
    return Answer(tuple(t.label for t in model.terms), model.inverse_dynamics)


def _is_here(tool: str) -> bool:
    if tool not in TOOLS:
        return True
    try:
        import_module(f"benchmarks.peers.{TOOLS[tool]}")
    except ImportError:
        return False
    return True
