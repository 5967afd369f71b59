"""Excitation: motions within an arm's limits that make parameters, or two confusable effects, visible."""

from cdia_pin.discovery.excitation.design import excite
from cdia_pin.discovery.excitation.limits import MotionLimits, motion_limits
from cdia_pin.discovery.excitation.result import Excitation, Gain
from cdia_pin.discovery.excitation.settings import ExcitationSettings

__all__ = ["Excitation", "ExcitationSettings", "Gain", "MotionLimits", "excite", "motion_limits"]
