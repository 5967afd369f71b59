"""The same case under other noise, again and again: do intervals hold the truth, and could any estimate be better?"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.hidden_effects.bounds import bound_of_conditioned, bound_of_log
from benchmarks.hidden_effects.case import NOISES, Case
from benchmarks.hidden_effects.drawing import drawn
from benchmarks.hidden_effects.oracle import unordered
from benchmarks.hidden_effects.truth import label_of, true_model
from cdia_pin.discovery import discover
from cdia_pin.dynamics import Dynamics

Array = NDArray[np.float64]

REPEATED = {  # effect: arm
    "coulomb_friction": "ur5",
    "viscous_friction": "panda",
    "actuator_gain": "kinova",
    "rotor_inertia": "z1",
    "joint_spring": "ur5",
    "base_tilt": "panda",
    "payload": "kinova",
    "position_ripple": "z1",  # its frequency is searched for
}
SHARE = 0.2  # of the joint's torque
TIMES = 40
FIRST_SEED = 100  # of the noise
COUNTED = {"payload": 4}  # parameters that are looked at: of a body, mass and first moments


@dataclass(frozen=True)
class Repeat:
    """One draw of the noise of a case."""

    effect: str
    arm: str
    number: int

    @property
    def case(self) -> Case:
        """The case that is repeated."""
        return Case("repeated", self.arm, (self.effect,), (SHARE,), "coloured")

    @property
    def id(self) -> str:
        """Name of the draw."""
        return f"{self.case.id}/noise {self.number}"


@dataclass(frozen=True)
class Estimate:
    """What came of a draw; one number for each parameter.

    Attributes:
        id: Name of the draw.
        effect: The hidden effect.
        arm: Name of the arm.
        exact: Whether it was named, and nothing else.
        names: Of the parameters.
        truth: True values.
        values: Estimated values; empty if the effect was not named.
        lower: Lower ends of the 95 % intervals.
        upper: Upper ends.
        bound: Cramér-Rao bound of the standard deviation from the whole log; of the first draw only.
        kept: The same from what the conditioning keeps.
    """

    id: str
    effect: str
    arm: str
    exact: bool
    names: tuple[str, ...]
    truth: tuple[float, ...]
    values: tuple[float, ...] = ()
    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    bound: tuple[float, ...] = ()
    kept: tuple[float, ...] = ()

    def to_json(self) -> str:
        """Return the estimate as a line of JSON."""
        return json.dumps(asdict(self), ensure_ascii=False)

    @classmethod
    def from_json(cls, line: str) -> Estimate:
        """Read back what `to_json` wrote."""
        return cls(**{k: tuple(v) if isinstance(v, list) else v for k, v in json.loads(line).items()})


@dataclass(frozen=True)
class Precision:
    """All draws of one parameter together.

    Attributes:
        effect: The hidden effect.
        arm: Name of the arm.
        parameter: Its name.
        searched: Whether a shape was searched for as well.
        draws: In how many the effect was named.
        bias: Mean error, in standard deviations of the estimates [1].
        covered: In how many the interval held the truth.
        variance: Variance over the Cramér-Rao bound of the whole log [1].
        of_kept: The same over that of what the conditioning keeps [1].
    """

    effect: str
    arm: str
    parameter: str
    searched: bool
    draws: int
    bias: float
    covered: int
    variance: float
    of_kept: float


def repeats(times: int = TIMES) -> list[Repeat]:
    """Return all draws, the first of each effect first."""
    return [Repeat(effect, arm, k) for k in range(times) for effect, arm in REPEATED.items()]


def run_repeat(repeat: Repeat) -> Estimate:
    """Run one draw."""
    plant, scenario = drawn(repeat.case)
    run = replace(scenario, noise_seed=FIRST_SEED + repeat.number).run(plant)
    true = true_model(plant, scenario.faults)
    assert true is not None
    (hidden,) = true.terms
    found = {
        unordered(s.term.label): s.term for s in discover(Dynamics(plant.robot), run.log).steps if s.term
    }
    count = COUNTED.get(repeat.effect, len(hidden.theta))
    out = Estimate(
        id=repeat.id,
        effect=repeat.effect,
        arm=repeat.arm,
        exact=set(found) == {unordered(label_of(scenario.faults[0]))},
        names=tuple(p.name for p in hidden.effect.parameters)[:count],
        truth=hidden.theta[:count],
    )
    if repeat.number == 0:
        noise = NOISES[repeat.case.noise]
        bounds = (f(true, hidden, run, noise)[:count] for f in (bound_of_log, bound_of_conditioned))
        out = replace(out, **dict(zip(("bound", "kept"), (tuple(b.tolist()) for b in bounds), strict=True)))
    named = found.get(unordered(hidden.label))
    if named is None or named.ci95 is None:
        return out
    lower, upper = (tuple(side[:count]) for side in zip(*named.ci95, strict=True))
    return replace(out, values=named.theta[:count], lower=lower, upper=upper)


def precisions(estimates: Sequence[Estimate]) -> Iterator[Precision]:
    """Yield what all draws say of each parameter."""
    for effect, arm in REPEATED.items():
        named = [e for e in estimates if e.effect == effect and e.values]
        bounds = [e for e in estimates if e.effect == effect and e.bound]
        if len(named) < 2 or not bounds:
            continue
        truth = np.array(named[0].truth)
        values, lower, upper = (
            np.array([getattr(e, k) for e in named]) for k in ("values", "lower", "upper")
        )
        deviation = values.std(axis=0, ddof=1)
        held = ((lower <= truth) & (truth <= upper)).sum(axis=0)
        for k, name in enumerate(named[0].names):
            yield Precision(
                effect=effect,
                arm=arm,
                parameter=name,
                searched=effect in {"position_ripple", "stribeck_friction"},
                draws=len(named),
                bias=float((values[:, k].mean() - truth[k]) / deviation[k]),
                covered=int(held[k]),
                variance=float((deviation[k] / bounds[0].bound[k]) ** 2),
                of_kept=float((deviation[k] / bounds[0].kept[k]) ** 2),
            )
