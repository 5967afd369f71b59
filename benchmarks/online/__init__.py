"""A closed loop to try monitors in: a plant that is not the model, faults that come and go, and what is known of them.

plant = OnlinePlant("ur5", seed=1)
for case in singles("ur5", share=0.2):
    run = case.run(plant, controller)        # run.fault_torque and run.faults are the truth
    detection_delay(run, events, thresholds, joint="elbow_joint")
"""

from benchmarks.online.control import NominalControl
from benchmarks.online.faults import ONLINE
from benchmarks.online.motions import Chain, Onward
from benchmarks.online.parts import torque_of
from benchmarks.online.plant import Controller, Drives, OnlinePlant
from benchmarks.online.run import OnlineRun
from benchmarks.online.scenarios import ARMS, Case, every_case
from benchmarks.online.sensors import EXACT, POSITION_ONLY, Sensors

__all__ = [
    "ARMS",
    "EXACT",
    "ONLINE",
    "POSITION_ONLY",
    "Case",
    "Chain",
    "Controller",
    "Drives",
    "NominalControl",
    "OnlinePlant",
    "OnlineRun",
    "Onward",
    "Sensors",
    "every_case",
    "torque_of",
]
