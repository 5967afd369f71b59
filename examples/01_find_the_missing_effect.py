"""Find what a UR5's model lacks in a log, add it, and see the error fall.

Usage:
    .venv/bin/python examples/01_find_the_missing_effect.py
"""

from cdia_pin import Dynamics, compare, discover, load_robot, logs_dir, read_log

robot = load_robot("ur5")
log = read_log(logs_dir() / "demo_ur5.csv", robot)
model = Dynamics(robot)

found = discover(model, log)
print(f"verdict: {found.verdict}")
for step in found.steps:
    print(f"  + {step.term.label}")
    for name, value in step.term.parameters_to_dict(robot).items():
        low, high = value["ci95"]
        if low * high > 0:  # the interval does not hold zero
            print(f"      {name} = {value['value']:.4g} {value['unit']}  [{low:.4g}, {high:.4g}]")

before, after = compare(model, log), compare(found.model, log)
print("error, % of torque RMS")
for joint, old, new in zip(robot.joints, before.relative_rms, after.relative_rms, strict=True):
    print(f"  {joint:22s} {100 * old:6.1f}  →  {100 * new:5.2f}")
