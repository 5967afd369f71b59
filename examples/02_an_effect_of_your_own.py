"""Write an effect as one line, add it beside what the vocabulary finds, and see the error fall.

The elbow of a simulated UR5 is braked by a torque that grows with the cube of its speed. No effect of the vocabulary
does that, so the search without the line ends as "unexplained".

Usage:
    .venv/bin/python examples/02_an_effect_of_your_own.py
"""

import numpy as np

from cdia_pin import (
    DiscoverySettings,
    Dynamics,
    Sensors,
    Term,
    discover,
    effects,
    exciting_trajectory,
    load_robot,
    simulate,
)

robot = load_robot("ur5")
brake = Term.of(effects.from_expression("-dq**3 * cos(q)", joint="elbow_joint"), coefficient=12.0)
plant = Dynamics(robot, (brake,))

rng = np.random.default_rng(1)
path = exciting_trajectory(robot, rng, duration=30.0)
log = simulate(plant, path, duration=30.0, sensors=Sensors(effort_noise=0.05), rng=rng)

for extra in ((), (effects.from_expression("-dq**3 * cos(q)"),)):
    found = discover(Dynamics(robot), log, settings=DiscoverySettings(extra=extra))
    elbow = robot.joint_index("elbow_joint")
    error, floor = found.trace[-1].heldout_rms[elbow], found.noise_floor[elbow]
    names = ", ".join(s.term.label for s in found.steps) or "nothing"
    print(f"{found.verdict:12s} held-out error {error:.3f} N·m, floor {floor:.3f} N·m; found {names}")
