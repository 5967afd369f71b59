"""The equation of motion with terms, and what runs it: files, simulation, trajectories."""

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.model_file import load_model, save_model

__all__ = ["Dynamics", "load_model", "save_model"]
