"""Make the demo's log: a UR5 in MuJoCo with effects hidden that its URDF does not know.

Hidden: Coulomb friction of 5 N·m on elbow_joint, and a payload of 1.5 kg 5 cm in front of the tool. Positions
have a quantum of 2e-5 rad, torques noise of 1 % of each joint's torque; velocity is not recorded.

Usage:
    python -m benchmarks.demo_log                 # writes examples/data/demo_ur5.csv
    python -m benchmarks.demo_log --out my.csv

Needs the package's development dependencies (MuJoCo).
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from benchmarks.outcomes import CHECKOUT
from benchmarks.plant import Fault, MujocoPlant, Noise, Run

OUT = CHECKOUT / "examples" / "data" / "demo_ur5.csv"
FAULTS = (
    Fault("coulomb_friction", joint="elbow_joint", level=5.0),
    Fault("payload", mass=1.5, com=(0.0, 0.0, 0.05), size=0.08),
)
NOISE = Noise(position_resolution=2e-5, effort_fraction=0.01)
DURATION, RATE, SEED = 40.0, 125.0, 11  # [s], [Hz]


def make_run() -> Run:
    """Run the plant with the demo's hidden effects."""
    return MujocoPlant("ur5").run(FAULTS, duration=DURATION, rate=RATE, noise=NOISE, seed=SEED, keep=False)


def write(run: Run, path: Path) -> None:
    """Write a log with no more digits than its sensors have, as CSV in the project's dialect."""
    log = run.log
    names = ["time", *(f"{signal}.{j}" for signal in ("position", "effort") for j in log.joints)]
    digits = ["%.3f"] + ["%.5f"] * len(log.joints) + ["%.4f"] * len(log.joints)
    rows = np.column_stack([log.time, log.position, log.effort])
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, rows, fmt=digits, delimiter=",", header=",".join(names), comments="")


def main() -> None:
    """Make the log and say what is in it."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.demo_log", description=__doc__.split("\n", maxsplit=1)[0]
    )
    parser.add_argument("--out", type=Path, default=OUT, help="CSV file to write")
    path = parser.parse_args().out
    run = make_run()
    write(run, path)
    hidden = ", ".join(f"{f} {dict(f.parameters)}" for f in run.faults)
    print(f"{path}: {len(run.log.time)} samples, {path.stat().st_size / 1e6:.2f} MB")
    print(f"hidden: {hidden}")
    print("torque noise [N·m]: " + ", ".join(f"{s:.3f}" for s in run.noise_std))


if __name__ == "__main__":
    main()
