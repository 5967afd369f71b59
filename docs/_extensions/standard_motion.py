"""The motion along which the catalogue shows every effect: a UR5 whose elbow swings faster and faster."""

from __future__ import annotations

from functools import cache

import numpy as np

from cdia_pin import RobotModel, load_robot
from cdia_pin.effects import Effect, Signal, State

ROBOT = "ur5"
DURATION, SAMPLES = 10.0, 2000  # [s], [1]
CENTRE = (0.0, -1.2, 1.2, -0.6, 0.8, 0.0)  # [rad], a posture in which gravity loads the elbow
AMPLITUDE = (0.4, 0.3, 0.8, 0.5, 0.5, 0.6)  # [rad]
PERIODS = (6.0, 7.0, 6.0, 5.0, 4.0, 5.0), (4.0, 5.0, 2.0, 3.0, 3.0, 2.5)  # [s], at the start and the end
COLD, WARM = 20.0, 50.0  # [°C], at the start and the end; only effects of the temperature are shown it


@cache
def robot() -> RobotModel:
    """Return the arm."""
    return load_robot(ROBOT)


@cache
def motion(warms: bool = False) -> State:
    """Return the motion.

    Args:
        warms: Whether the joints warm on the way.
    """
    first, last = 2 * np.pi / np.array(PERIODS)  # [rad/s]
    time = np.linspace(0.0, DURATION, SAMPLES)[:, None]
    growth = (last - first) / DURATION  # [rad/s²]
    phase, speed = (first + growth * time / 2) * time, first + growth * time
    q = CENTRE + AMPLITUDE * np.sin(phase)
    v = AMPLITUDE * speed * np.cos(phase)
    a = AMPLITUDE * (growth * np.cos(phase) - speed**2 * np.sin(phase))
    tau = robot().inverse_dynamics(q, v, a)
    temperature = np.linspace(COLD, WARM, SAMPLES)[:, None] + np.zeros_like(q) if warms else None
    return State(robot(), q, v, a, tau, time[:, 0], temperature=temperature)


def motion_for(effect: Effect) -> State:
    """Return the motion on which an effect is shown."""
    return motion(warms=Signal.TEMPERATURE in effect.traits.depends_on)
