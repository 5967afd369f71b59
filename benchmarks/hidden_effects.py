"""Hidden effects: faults put into an arm in MuJoCo, and what `discover` names from its log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.plant import Fault, MujocoPlant, scenarios
from benchmarks.plant.scenarios import Scenario
from cdia_pin.discovery import Discovery, discover
from cdia_pin.dynamics import Dynamics

ARMS = ("ur5", "panda")
FRACTION = 0.2  # RMS torque of a hidden effect over that of its joint [1]
OTHER_FRACTIONS = (0.1, 0.5)  # for single effects only
KINDS = {
    "singles": scenarios.singles,
    "pairs": scenarios.pairs,
    "triples": scenarios.triples,
    "outside": scenarios.outside,
}


@dataclass(frozen=True)
class Case:
    """One hidden set of effects and what was found.

    Attributes:
        arm: Name of the arm.
        kind: ``singles``, ``pairs``, ``triples``, ``outside`` (of the vocabulary) or ``clean``.
        fraction: Size of each hidden effect, RMS torque over that of its joint [1]; 0 where nothing is hidden.
        title: What tells the case from others of its kind.
        hidden: Labels of the hidden effects.
        found: Labels of the effects that were named.
        verdict: Of the discovery.
        over_floor: Held-out RMS over noise floor, largest over the joints [1].
        parameter_error: Relative error of the main parameter of each hidden effect that was named [1].
        seconds: Wall time of `discover` [s].
    """

    arm: str
    kind: str
    fraction: float
    title: str
    hidden: tuple[str, ...]
    found: tuple[str, ...]
    verdict: str
    over_floor: float
    parameter_error: tuple[float, ...]
    seconds: float

    @property
    def exact(self) -> bool:
        """Whether the names and joints found are those hidden, no more and no fewer."""
        return sorted(map(_unordered, self.found)) == sorted(map(_unordered, self.hidden))

    @property
    def as_hoped(self) -> bool:
        """Exact names; the verdict `nothing-missing` where nothing is; `unexplained` outside the vocabulary."""
        if self.kind == "outside":
            return self.verdict == "unexplained"
        return self.exact and (self.kind != "clean" or self.verdict == "nothing-missing")


def planned() -> Iterator[tuple[MujocoPlant, str, float, Scenario]]:
    """Yield plant, kind, fraction and scenario of every case, in the order of the tables."""
    for arm in ARMS:
        plant = MujocoPlant(arm)
        for kind, recipes in KINDS.items():
            yield from ((plant, kind, FRACTION, s) for s in recipes(plant, fraction=FRACTION))
        yield from ((plant, "clean", 0.0, s) for s in scenarios.clean())
        for fraction in OTHER_FRACTIONS:
            yield from ((plant, "singles", fraction, s) for s in scenarios.singles(plant, fraction=fraction))


def measure(plant: MujocoPlant, kind: str, fraction: float, scenario: Scenario) -> Case:
    """Make the run, ask `discover` what is missing, and hold its answer against the truth."""
    run = scenario.run(plant)
    began = perf_counter()
    found = discover(Dynamics(plant.robot), run.log)
    seconds = perf_counter() - began
    return Case(
        arm=plant.robot.name,
        kind=kind,
        fraction=fraction,
        title=scenario.name.rpartition(", ")[2] if kind == "clean" else "",
        hidden=tuple(map(str, scenario.faults)),
        found=tuple(s.term.label for s in found.steps if s.term),
        verdict=found.verdict,
        over_floor=float(np.max(found.trace[-1].heldout_rms / np.maximum(found.noise_floor, 1e-12))),
        parameter_error=tuple(_parameter_errors(found, scenario.faults)),
        seconds=seconds,
    )


def _parameter_errors(found: Discovery, faults: Sequence[Fault]) -> Iterator[float]:
    values = {_unordered(s.term.label): s.term.values for s in found.steps if s.term}
    for fault in faults:
        estimated, true = values.get(_unordered(str(fault)), {}), main_parameter(fault)
        if all(name in estimated for name in true):
            error = [estimated[name] - value for name, value in true.items()]
            yield float(np.linalg.norm(error) / np.linalg.norm(list(true.values())))


def main_parameter(fault: Fault) -> dict[str, float]:
    """Return the parameter that a fault states first, a vector by its components."""
    name, value = next(iter(fault.parameters.items()))
    if isinstance(value, tuple):
        return {f"{name}_{axis}": x for axis, x in zip("xyz", value, strict=True)}
    return {name: float(value or 0.0)}


def _unordered(label: str) -> tuple[str, ...]:
    """Return an effect's name and its joints, whichever of two is written first."""
    name, _, joints = label.partition("@")
    return name, *sorted(joints.split("+"))
