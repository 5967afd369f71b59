"""The thesis' scheme of change detection, isolation and accommodation, with its equations corrected."""

from cdia_pin.diagnosis.thesis.basis import KnownEffects, Neurons
from cdia_pin.diagnosis.thesis.gains import FixedGains, ScaledGains
from cdia_pin.diagnosis.thesis.thesis_engine import ThesisEngine
from cdia_pin.diagnosis.thesis.thesis_settings import ThesisSettings

__all__ = ["FixedGains", "KnownEffects", "Neurons", "ScaledGains", "ThesisEngine", "ThesisSettings"]
