"""Faults of a scenario in their sizes: as shares of the torque that their joints need for the motion."""

from __future__ import annotations

import numpy as np

from cdia_pin.campaigns.closed_loop import ClosedLoop
from cdia_pin.campaigns.scenario import Scenario
from cdia_pin.dynamics.trajectories import Trajectory
from cdia_pin.effects import State, Term, parse_term
from cdia_pin.errors import EffectError

SIZING = 1000  # samples of the motion along which a fault is sized


def hidden(loop: ClosedLoop, motion: Trajectory, scenario: Scenario) -> tuple[Term, ...]:
    """Return the faults of a scenario in their sizes.

    Args:
        loop: The arm.
        motion: The desired motion, along which they are sized.
        scenario: What happens.

    Raises:
        EffectError: If a fault is to be sized and has no torque along the motion.
    """
    robot = loop.model.robot
    terms = tuple(parse_term(text, robot) for text in scenario.faults)
    if scenario.share is None:
        return terms
    time = np.linspace(0.0, scenario.duration, SIZING)
    asked = motion(time)
    x = State.of(robot, asked.q, asked.v, asked.a, time=time)
    return tuple(sized(term, x, scenario.share) for term in terms)


def sized(term: Term, x: State, share: float) -> Term:
    """Return a term whose RMS torque is a share of that of its joints; its profile does not count.

    Args:
        term: The term; its parameters are all multiplied by the same number.
        x: A motion of the healthy arm.
        share: RMS torque of the term over that of its joints [1].

    Raises:
        EffectError: If it has no torque along the motion.
    """
    joints = [x.robot.joint_index(j) for j in term.effect.scope] or list(range(x.robot.n))
    torque = term.effect.torque(x, np.array(term.theta))[:, joints]
    size = float(np.sqrt(np.mean(torque**2)))
    if not size > 0:
        raise EffectError(f"{term.label} has no torque along the motion, so it cannot have a share of it")
    wanted = share * float(np.sqrt(np.mean(x.effort[:, joints] ** 2)))
    return term.with_theta(wanted / size * np.array(term.theta))
