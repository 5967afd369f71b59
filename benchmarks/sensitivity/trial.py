"""One discovery with one setting changed, against the truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from benchmarks.hidden_effects.case import Case
from benchmarks.hidden_effects.drawing import drawn, recorded
from benchmarks.hidden_effects.truth import label_of
from benchmarks.outcomes import JsonLine
from benchmarks.sensitivity.variation import Variation
from cdia_pin.discovery import discover
from cdia_pin.dynamics import Dynamics

SUITE = "sensitivity"  # part of each case's name, and so of its seed: no other benchmark has these draws
HIDDEN: tuple[
    tuple[str, str, tuple[str, ...], tuple[float, ...]], ...
] = (  # arm, noise, effects, shares of the torque
    ("ur5", "white", ("coulomb_friction",), (0.05,)),
    ("panda", "coloured", ("stribeck_friction", "payload"), (0.2, 0.2)),
    ("kinova", "quantised", ("actuator_gain", "viscous_friction"), (0.1, 0.05)),
    ("panda", "quantised", ("quadratic_friction", "torque_offset", "load_friction"), (0.1, 0.05, 0.1)),
    ("z1", "coloured", (), ()),
)
LINK_ERROR = 0.04  # of all links in the first case [1]


@dataclass(frozen=True)
class Trial:
    """A case with a variation of the settings."""

    case: Case
    variation: Variation

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.variation.id} | {self.case.id}"


@dataclass(frozen=True)
class TrialOutcome(JsonLine):
    """What came of it.

    Attributes:
        id: Name of the trial.
        variation: Name of the variation.
        missed: Hidden effects that were not found.
        spurious: Effects found that were not hidden; links that are all wrong are not counted.
        alternatives: Number of other explanations listed.
        unexplained: Whether structure was said to be left.
    """

    id: str
    variation: str
    missed: int
    spurious: int
    alternatives: int
    unexplained: bool


def cases() -> Iterator[Case]:
    """Yield the cases."""
    for k, (arm, noise, effects, shares) in enumerate(HIDDEN):
        yield Case(SUITE, arm, effects, shares, noise, model_error=0.0 if k else LINK_ERROR)


def run_trial(trial: Trial) -> TrialOutcome:
    """Run one trial."""
    plant, scenario = drawn(trial.case)
    log = recorded(trial.case, scenario.run(plant))
    found = discover(Dynamics(plant.robot), log, settings=trial.variation.settings())
    hidden = {label_of(f) for f in scenario.faults}
    labels = {step.term.label for step in found.steps if step.term is not None}
    every_link = {x for x in labels if trial.case.model_error and x.startswith("link_inertia@") and "+" in x}
    return TrialOutcome(
        id=trial.id,
        variation=trial.variation.id,
        missed=len(hidden - labels),
        spurious=len(labels - hidden - every_link),
        alternatives=sum(len(step.confusions) for step in found.steps),
        unexplained=bool(found.structure_left),
    )
