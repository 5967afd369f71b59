"""Identification: the inertial parameters of all links, friction and rotors, fitted together to logs."""

from cdia_pin.identification.base import BaseParameters
from cdia_pin.identification.estimation import identify
from cdia_pin.identification.gain_calibration import GainCalibration, calibrate_gains
from cdia_pin.identification.identification_result import Identification
from cdia_pin.identification.identification_settings import IdentificationSettings

__all__ = [
    "BaseParameters",
    "GainCalibration",
    "Identification",
    "IdentificationSettings",
    "calibrate_gains",
    "identify",
]
