"""The equation of motion with terms, model files, trajectories, control and simulation."""

from cdia_pin.dynamics.controllers import ComputedTorque, Controller
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.model_file import load_model, save_model
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.dynamics.simulate import Run, record, run_plant, simulate
from cdia_pin.dynamics.torques import Torques
from cdia_pin.dynamics.trajectories import FourierTrajectory, Reference, Trajectory, exciting_trajectory

__all__ = [
    "ComputedTorque",
    "Controller",
    "Dynamics",
    "FourierTrajectory",
    "Reference",
    "Run",
    "Sensors",
    "Torques",
    "Trajectory",
    "exciting_trajectory",
    "load_model",
    "record",
    "run_plant",
    "save_model",
    "simulate",
]
