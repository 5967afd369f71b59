"""Excitation: motions within an arm's limits that make parameters, or two confusable effects, visible."""

from cdia_pin.excitation.design import excite
from cdia_pin.excitation.excitation_result import Excitation, Gain
from cdia_pin.excitation.excitation_settings import ExcitationSettings
from cdia_pin.excitation.limits import MotionLimits, motion_limits

__all__ = ["Excitation", "ExcitationSettings", "Gain", "MotionLimits", "excite", "motion_limits"]
