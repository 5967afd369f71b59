"""Watch a UR5 whose elbow gains Coulomb friction while it moves: the fault is detected, isolated and compensated.

Usage:
    .venv/bin/python examples/03_watch_an_arm.py
"""

from cdia_pin import ClosedLoop, Dynamics, effects, load_robot

robot = load_robot("ur5")
loop = ClosedLoop(Dynamics(robot))  # noisy sensors, and inertias that differ from the model's by up to 3 %
fault = effects.parse_term("coulomb_friction@elbow_joint: level=5, after=4", robot)
motion = loop.motion(0, duration=15.0)

monitor = loop.monitor()  # learns from healthy runs on other motions
watched = loop.run(motion, [fault], monitor)
for event in monitor.events:
    names = ", ".join(f"{t.label} {t.values}" for t in event.faults)
    print(f"{event.time:7.3f} s  {event.stage:13s} {event.verdict:8s} {names}")

elbow = robot.joint_index("elbow_joint")
healthy, faulty = loop.run(motion), loop.run(motion, [fault])
for name, run in (("healthy", healthy), ("faulty", faulty), ("accommodated", watched)):
    print(f"{name:13s} elbow tracks to {1e3 * run.tracking(since=5.0)[elbow]:6.2f} mrad RMS")
