"""Regression: y = X θ + e of conditioned logs, whatever the search that asks for it."""
