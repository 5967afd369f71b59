"""Identify all links and frictions of an arm, write them into a URDF, and see another motion predicted better.

The simulated UR5 has a tool, and friction on every joint. Its URDF knows of neither.

Usage:
    .venv/bin/python examples/06_correct_the_urdf.py
"""

import tempfile
from pathlib import Path

import numpy as np

from cdia_pin import (
    Dynamics,
    Sensors,
    Term,
    compare,
    effects,
    exciting_trajectory,
    identify,
    load_robot,
    simulate,
    write_corrected_urdf,
)

robot = load_robot("ur5")
friction = [
    Term.of(effects.ViscousFriction(joint), coefficient=0.05 * limit)
    for joint, limit in zip(robot.joints, robot.limits.effort, strict=True)
]
tool = effects.parse_term("payload: mass=1.5, first_moment_z=0.08", robot)
plant = Dynamics(robot, (tool, *friction))


def recorded(seed):
    """Return a log of the plant on a motion of its own."""
    path = exciting_trajectory(robot, np.random.default_rng(seed), duration=30.0)
    return simulate(plant, path, sensors=Sensors(effort_share=0.01), rng=np.random.default_rng(seed))


found = identify(Dynamics(robot), recorded(1))
links = dict(zip(robot.joints, found.inertial_parameters, strict=True))
with tempfile.TemporaryDirectory() as folder:
    corrected = load_robot(write_corrected_urdf(robot, Path(folder) / "corrected.urdf", inertial=links))

other = recorded(2)
for name, model in (
    ("URDF as given", Dynamics(robot)),
    ("corrected links", Dynamics(corrected)),
    ("and friction", found.model),
):
    print(f"{name:16s} error on another motion {100 * np.mean(compare(model, other).relative_rms):5.1f} %")
