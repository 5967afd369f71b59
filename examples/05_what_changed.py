"""Compare two logs of an arm: what changed between them is named, and the model is mended by it.

A simulated UR5 has friction on every joint, and between two days somebody mounts a tool. The URDF knows of neither,
and the motions of the two days differ. What is common to both days needs no model.

Usage:
    .venv/bin/python examples/05_what_changed.py
"""

import numpy as np

from cdia_pin import (
    Dynamics,
    Sensors,
    Term,
    compare,
    effects,
    exciting_trajectory,
    load_robot,
    simulate,
    what_changed,
)

robot = load_robot("ur5")
model = Dynamics(robot)
usual = [
    Term.of(effects.CoulombFriction(joint), level=0.05 * limit)
    for joint, limit in zip(robot.joints, robot.limits.effort, strict=True)
]
tool = effects.parse_term("payload: mass=0.8, first_moment_z=0.04", robot)


def recorded(terms, day):
    """Return a log of an arm with some effects; the day is the seed of its motion and noise."""
    path = exciting_trajectory(robot, np.random.default_rng(day), duration=30.0)
    sensors = Sensors(effort_share=0.01, position_quantum=1e-5)
    return simulate(Dynamics(robot, tuple(terms)), path, sensors=sensors, rng=np.random.default_rng(day))


monday, friday = recorded(usual, 1), recorded([*usual, tool], 2)
found = what_changed(model, monday, friday)
for change in found.changes:
    mass = change.term.values.get("mass", np.nan)
    print(f"{change.term.label} changed ({change.confidence}): {mass:+.2f} kg, in truth +0.80 kg")

known = Dynamics(robot, tuple(usual))
mended = Dynamics(robot, (*usual, *(change.term for change in found.changes)))
before, after = (compare(each, friday).relative_rms for each in (known, mended))
print(f"Monday's model on Friday's log: error {100 * np.mean(before):.1f} % of the torque")
print(f"with what changed:              error {100 * np.mean(after):.1f} %")
