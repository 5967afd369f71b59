"""What a proposed motion is worth: record the same arm on it, and ask again with both logs."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.plant.motion import Given
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.scenarios import HOLDOUT, Scenario
from cdia_pin.discovery import Discovery, discover
from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import EffectError
from cdia_pin.excitation import excite
from cdia_pin.logs import Log


def resolved(plant: MujocoPlant, scenario: Scenario, log: Log, found: Discovery) -> Discovery | None:
    """Return what is found on a log and on a log of the motion between the first two explanations.

    Args:
        plant: The arm, with what is hidden in it.
        scenario: What it did.
        log: What was recorded.
        found: What `discover` made of it, and what it says that can be confused.

    Returns:
        None if there is nothing to be told apart, or no motion that would.
    """
    doubts = [(s.term.effect, c.effects) for s in found.steps if s.term for c in s.confusions]
    if not doubts:
        return None
    one, other = doubts[0]
    try:
        motion = excite(found.model, between=(one, other), after=log).trajectory
    except EffectError:  # no motion does
        return None
    again = replace(
        scenario,
        motion=Given(motion, motion.duration),
        duration=motion.duration,
        seed=scenario.seed + 2 * HOLDOUT,
    )
    return discover(Dynamics(plant.robot), [log, again.run(plant).log])
