"""Coloured noise: over a few draws nothing is found in it, and intervals of what is there hold the truth.

`python -m benchmarks.hidden_effects` counts intervals that hold the truth over forty draws of each of its cases.
"""

from functools import cache

import numpy as np
import pytest

from benchmarks.plant import Fault, Noise
from cdia_pin import Dynamics
from cdia_pin.discovery import Discovery, discover
from tests.hidden_plants import labels, plant_of

COLOURS = ("white", "ar1", "pink")
SEEDS = range(4)
# four levels do not tell their own scatter: by chance one mean in 17 is off by three of its standard errors
MANY = range(16)
JOINT, LEVEL = "joint2", 0.05  # [N·m], a quarter of the joint's RMS torque


@cache
def found(colour: str, seed: int, level: float) -> Discovery:
    """What is found in 20 s of a double pendulum whose torques have noise of 2 %."""
    plant = plant_of("double_pendulum")
    faults = [Fault("coulomb_friction", joint=JOINT, level=level)] if level else []
    run = plant.run(faults, duration=20.0, seed=seed, noise=Noise(colour=colour, effort_fraction=0.02))
    return discover(Dynamics(plant.robot), run.log)


@pytest.mark.parametrize("colour", COLOURS)
def test_nothing_is_found_in_noise(colour):
    results = [found(colour, seed, 0.0) for seed in SEEDS]
    assert [labels(r) for r in results] == [set()] * len(results)
    assert [r.verdict for r in results] == ["nothing-missing"] * len(results)


@pytest.mark.parametrize("colour", COLOURS)
def test_friction_is_found_by_name_in_noise(colour):
    results = [found(colour, seed, LEVEL) for seed in SEEDS]
    assert [labels(r) for r in results] == [{f"coulomb_friction@{JOINT}"}] * len(results)
    assert [r.verdict for r in results] == ["explained"] * len(results)


@pytest.mark.parametrize("colour", COLOURS)
def test_intervals_hold_the_truth(colour):
    terms = [found(colour, seed, LEVEL).steps[0].term for seed in SEEDS]
    assert sum(low <= LEVEL <= high for t in terms for low, high in t.ci95[:1]) >= len(SEEDS) - 1


@pytest.mark.parametrize("colour", COLOURS)
def test_estimates_scatter_around_the_truth(colour):
    """What is wrong at reversals must not lean the estimate to one side, whatever the noise."""
    levels = np.array([found(colour, seed, LEVEL).steps[0].term.theta[0] for seed in MANY])
    error = levels / LEVEL - 1
    assert abs(error.mean()) < max(0.003, 3 * error.std(ddof=1) / np.sqrt(len(error)))


def test_slower_noise_makes_wider_intervals():
    half = {
        colour: np.median([np.ptp(found(colour, seed, LEVEL).steps[0].term.ci95[0]) for seed in SEEDS])
        for colour in COLOURS
    }
    assert half["white"] < half["ar1"] < half["pink"]
