"""Regression: y = X θ + e of conditioned logs. It does not depend on what the fit is for."""

from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.lack_of_fit import LackOfFitSettings
from cdia_pin.regression.noise import NoiseSettings
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.rest import RestSettings

__all__ = [
    "Experiment",
    "LackOfFitSettings",
    "NoiseSettings",
    "NormalEquations",
    "Prediction",
    "Regression",
    "RestSettings",
]
