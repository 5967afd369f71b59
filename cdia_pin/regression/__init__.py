"""Regression: y = X θ + e of conditioned logs. It does not depend on what the fit is for."""
