"""A plant that is not our model: a robot arm in MuJoCo with faults of known size hidden in it.

    plant = MujocoPlant("ur5")
    run = plant.run([Fault("coulomb_friction", joint="elbow_joint", level=4.0), Fault("payload", mass=2.0)])
    run.log, run.truth, run.noise_std

The robot's file and names come from the package; its effects and its dynamics are not used here.
"""

from benchmarks.plant.faults import MECHANISMS, OUTSIDE, VOCABULARY, Fault
from benchmarks.plant.motion import Fourier, Motion, PointToPoint, single, slow, small
from benchmarks.plant.noise import CLEAN, Noise
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.run import Run, Truth

__all__ = [
    "CLEAN",
    "MECHANISMS",
    "OUTSIDE",
    "VOCABULARY",
    "Fault",
    "Fourier",
    "Motion",
    "MujocoPlant",
    "Noise",
    "PointToPoint",
    "Run",
    "Truth",
    "single",
    "slow",
    "small",
]
