"""From a case to a run: joints, sizes and motion are drawn from the case's seed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from benchmarks.hidden_effects.case import BETWEEN_POINTS, DURATION, GOOD, SENSORS, Case
from benchmarks.plant.faults import MECHANISMS, Fault, scaled
from benchmarks.plant.model_error import erroneous
from benchmarks.plant.motion import Fourier, Motion, PointToPoint, slow, small
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.poor import OneWay, SingleSpeed, planar
from benchmarks.plant.run import Run
from benchmarks.plant.scenarios import OUTSIDE_PARAMETERS, PARAMETERS, Scenario
from benchmarks.plant.sizes import Sizer
from cdia_pin.logs import Log

LOADED = 0.05  # a joint takes part if it carries this share of the largest joint torque, RMS
EITHER_WAY = (
    "torque_offset",
    "position_ripple",
    "actuator_gain",
    "encoder_offset",
    "base_tilt",
    "tool_wrench",
)
DRAWN = {  # shapes that are drawn, between these
    "position_ripple": ("frequency", 5.0, 14.0),  # [1/rad]
    "stribeck_friction": ("decay", 5.0, 12.0),  # [s/rad]
}


@lru_cache(maxsize=8)
def plant_of(arm: str) -> MujocoPlant:
    """Return an arm as its file describes it; the same one each time."""
    return MujocoPlant(arm)


def drawn(case: Case) -> tuple[MujocoPlant, Scenario]:
    """Return the plant of a case, and what it is to do.

    Raises:
        ValueError: If an effect cannot be given its size on any joint.
    """
    plant, rng = plant_of(case.arm), np.random.default_rng(case.seed)
    look = Sizer(plant, Fourier(), DURATION, case.seed)
    faults = _faults(case, look, rng)
    moved = faults[0].joint if faults and faults[0].joint else str(rng.choice(_loaded(look)))
    scenario = Scenario(
        case.id, faults, case.seed, _motion(case.excitation, plant, moved), SENSORS[case.noise], case.duration
    )
    if case.model_error:
        wrong = erroneous(plant.nominal.file.inertias, case.model_error, case.seed)
        plant = MujocoPlant(plant.robot, inertias=wrong)
    return plant, scenario


def recorded(case: Case, run: Run) -> Log:
    """Return the log of a run, as long as it is recorded."""
    cut = round(case.cut * run.log.rate)
    return run.log.slice(cut, len(run.log.time) - cut)


def _faults(case: Case, look: Sizer, rng: np.random.Generator) -> tuple[Fault, ...]:
    """Draw the faults of a case: all on one joint if its number is even and they can be, on others if odd."""
    order = rng.permutation(_loaded(look)).tolist()
    out: list[Fault] = []
    for k, (effect, share) in enumerate(zip(case.effects, case.shares, strict=True)):
        turn = k * (case.number % 2) % max(len(order), 1)
        out.append(_sized(effect, share, look, [*order[turn:], *order[:turn]], rng))
    return tuple(out)


def _sized(effect: str, share: float, look: Sizer, joints: Sequence[str], rng: np.random.Generator) -> Fault:
    given = dict((PARAMETERS | OUTSIDE_PARAMETERS)[effect])
    if effect in DRAWN:
        name, lower, upper = DRAWN[effect]
        given[name] = float(rng.uniform(lower, upper))
    sign = rng.choice([-1.0, 1.0]) if effect in EITHER_WAY else 1.0
    places = MECHANISMS[effect].places
    if effect == "link_inertia":  # of the first link a motion shows a rotor, and the last one's is a payload
        inner = look.plant.joints[1:-1]
        joints = [j for j in joints if j in inner]
    for joint in joints if places else [None]:
        other = look.beside(joint) if places == 2 and joint else None
        fault = scaled(Fault(effect, joint=joint, other=other, **given), sign)
        try:
            return look.sized(fault, share)
        except ValueError:  # next to no torque of this kind on this joint
            continue
    raise ValueError(
        f"{effect} cannot have {share:.0%} of the torque of any joint of {look.plant.robot.name}"
    )


def _loaded(look: Sizer) -> list[str]:
    return [j for j, r in zip(look.plant.joints, look.rms, strict=True) if r >= LOADED * look.rms.max()]


def _motion(excitation: str, plant: MujocoPlant, joint: str) -> Motion:
    kinds = {
        GOOD: Fourier,
        BETWEEN_POINTS: PointToPoint,
        "one joint": lambda: Fourier(harmonics=1, joints=(joint,)),
        "slow": lambda: slow(0.05),
        "one posture": lambda: small(0.005),
        "single speed": SingleSpeed,
        "one way": OneWay,
        "planar": lambda: planar(plant.nominal, plant.reach.middle),
    }
    return kinds[excitation]()
