"""Identifiability: which effects logs can distinguish, and which motion would."""

from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import distinguishing_motion, motion_between, why_alike

__all__ = ["Confusion", "distinguishing_motion", "motion_between", "why_alike"]
