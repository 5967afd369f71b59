"""What the neurons of an unknown fault can learn: torques that no formula of the bank has."""

import numpy as np
import pytest

from cdia_pin import MonitorSettings
from cdia_pin.diagnosis.approximation import neurons_over, weights
from cdia_pin.effects import JointState

SHAPES = {
    "a resonance at one speed": lambda q, v: np.exp(-(((np.abs(v) - 0.25) / 0.06) ** 2)) * np.sign(v),
    "cogging that grows with speed": lambda q, v: np.sin(7.0 * q) * v,
    "a stiffening spring": lambda q, v: q**3,
}


@pytest.mark.parametrize("shape", SHAPES)
def test_neurons_learn_what_is_local_in_speed_or_position(shape):
    settings = MonitorSettings()
    unknown = neurons_over(
        "joint1", np.array([-2.0, 2.0]), np.array([-1.5, 1.5]), settings.neurons, settings.velocity_neurons
    )
    t = np.arange(0.0, 20.0, 0.004)
    q, v = np.sin(0.9 * t) + 0.4 * np.sin(2.2 * t), 0.9 * np.cos(0.9 * t) + 0.88 * np.cos(2.2 * t)
    missing = SHAPES[shape](q, v)
    columns = np.column_stack(unknown.columns(JointState(q, v, 0 * q, 10.0 * np.cos(q), np.sign(v), t)))
    seen = t < 15.0
    together = np.column_stack([columns, missing])[seen]
    found = weights(together.T @ together, unknown.counts)
    left = (missing - columns @ found)[~seen]
    assert np.mean(left**2) < 0.1 * missing[~seen].var()


def test_a_neuron_whose_place_was_not_visited_gets_no_weight():
    unknown = neurons_over("joint1", np.array([-2.0, 2.0]), np.array([-1.0, 1.0]), 5, 5)
    q = np.linspace(-2.0, 0.0, 500)
    columns = np.column_stack(unknown.columns(JointState(q, 0.5 + 0 * q, 0 * q, 1 + 0 * q, 1 + 0 * q, q)))
    together = np.column_stack([columns, np.sin(q)])
    found = weights(together.T @ together, unknown.counts)
    assert found[4] == 0.0
    assert found[1] != 0.0
