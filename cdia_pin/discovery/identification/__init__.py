"""Identification: the inertial parameters of all links, friction and rotors, fitted together to logs."""

from cdia_pin.discovery.identification.base import BaseParameters
from cdia_pin.discovery.identification.identifying import identify
from cdia_pin.discovery.identification.result import Identification
from cdia_pin.discovery.identification.settings import IdentificationSettings

__all__ = ["BaseParameters", "Identification", "IdentificationSettings", "identify"]
