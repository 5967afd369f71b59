"""Tell a spring from a heavier link: a small motion cannot; a motion designed for it, within the arm's limits, can.

Usage:
    .venv/bin/python examples/04_tell_two_effects_apart.py
"""

import numpy as np

from cdia_pin import (
    Dynamics,
    Sensors,
    discover,
    effects,
    excite,
    exciting_trajectory,
    load_robot,
    simulate,
)

robot = load_robot("ur5")
model = Dynamics(robot)
spring = effects.parse_term("joint_spring@shoulder_lift_joint: stiffness=10", robot)
plant = Dynamics(robot, (spring,))
sensors = Sensors(effort_share=0.01, position_quantum=1e-5)


def explained(log):
    """Print the missing effect and its alternatives; return the alternatives."""
    found = discover(model, log)
    (step,) = found.steps
    rivals = [effect for confusion in step.confusions for effect in confusion.effects]
    print(f"{step.term.label}, or {' or '.join(e.label for e in rivals) or 'nothing else'}")
    return rivals


small = exciting_trajectory(robot, np.random.default_rng(1), duration=30.0, speed=0.03)
log = simulate(plant, small, sensors=sensors, rng=np.random.default_rng(2))
rivals = explained(log)

motion = excite(model, between=(spring.effect, rivals[0]), after=log)
for signal, peak in motion.peaks().items():
    print(f"  {signal:12s}", np.round(peak, 2), "of", np.round(getattr(motion.limits, signal), 2))
left = explained(simulate(plant, motion.trajectory, sensors=sensors, rng=np.random.default_rng(3)))

for name, others, apart in (
    ("small motion", rivals, motion.gain.before),
    ("designed motion", left, motion.gain.after),
):
    print(f"{name:16s} {1 + len(others)} possible, spring and link {apart:.1f} standard deviations apart")
