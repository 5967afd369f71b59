"""Runs of an arm with a load for some time, whose model is wrong by half a newton metre at each posture."""

from dataclasses import replace

import numpy as np
from made_logs import Made, make

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
from cdia_pin.robot import load_robot

ARM = load_robot("ur5")
MASS = 2.5  # [kg]
LOAD = parse_term(f"payload: mass={MASS}, first_moment_x=0.05, first_moment_y=0.07, first_moment_z=0.15", ARM)


def loaded_run(seed: int, *loaded: tuple[float, float], duration: float) -> tuple[Made, Log]:
    """Return a motion, and the log of an arm that moves so with the load at some times [s].

    Args:
        seed: Of motion and noise.
        loaded: From when to when it carries the load [s].
        duration: Of the run [s].
    """
    made = make(ARM, lambda q, v, a: 0.5 * np.sin(3.0 * q), seed=seed, duration=duration, noise=0.2)
    t, effort = made.log.time, made.log.effort.copy()
    carried, free = (Dynamics(ARM, terms).inverse_dynamics(made.q, made.v, made.a) for terms in ((LOAD,), ()))
    for begin, end in loaded:
        there = (t >= begin) & (t < end)
        effort[there] += (carried - free)[there]
    return made, replace(made.log, effort=effort, source=f"run {seed}")
