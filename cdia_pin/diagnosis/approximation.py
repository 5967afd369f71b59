"""An unknown fault, learned as radial bases in q and q̇, damping in q, and one torque neuron ([Thesis] eq. 3.1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.joint_gram import gram_parts
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.effects import Term, Unknown

Array = NDArray[np.float64]

WIDEST_RANGE = (
    10.0  # [rad or m, and per s], largest position and speed that neurons cover where nothing limits them
)
LEAST_RANGE = 1e-3  # [rad or m, and per s], so that neurons of a signal that stood still do not coincide
OVERLAP = 1.5  # [1], width of a neuron over the distance to the next: neighbours blend without a gap
RIDGE = 1e-3  # [1], penalty of the weights over the mean energy of their columns: keeps them bounded
VISITED = 0.03  # [1], energy of a neuron over the mean of its kind, below which only its tail was seen
VISIBLE = 2.0  # [1], learned torque over the threshold, from which its absence would show
CLEARED_AFTER = 0.6  # [s] without the learned torque, where it would show, after which the fault is cleared


def neurons_over(joint: str, position: Array, velocity: Array, count: int, in_velocity: int) -> Unknown:
    """Return neurons spread evenly over ranges of a joint's position and velocity.

    Args:
        joint: Name of the joint.
        position: Smallest and largest position [rad or m], shape (2,).
        velocity: Smallest and largest velocity [rad/s or m/s], shape (2,).
        count: Neurons in position, and as many of damping; at least two.
        in_velocity: Neurons in velocity; at least two.
    """
    q0, q1 = np.clip(position, -WIDEST_RANGE, WIDEST_RANGE)
    v0, v1 = np.clip(velocity, -WIDEST_RANGE, WIDEST_RANGE)
    q = np.linspace(q0, max(q1, q0 + LEAST_RANGE), max(count, 2))
    v = np.linspace(v0, max(v1, v0 + LEAST_RANGE), max(in_velocity, 2))
    return Unknown(
        joint=joint,
        position_centres=tuple(q.tolist()),
        velocity_centres=tuple(v.tolist()),
        position_width=float(OVERLAP * (q[1] - q[0])),
        velocity_width=float(OVERLAP * (v[1] - v[0])),
        damping_centres=tuple(q.tolist()),
    )


def weights(gram: Array, counts: Sequence[int]) -> Array:
    """Return the weights of the neurons that explain a residual, by ridge regression, shape (H,).

    One penalty serves all neurons of a kind. A neuron that the motion has hardly visited gets no weight.

    Args:
        gram: Gram matrix of the neurons and the residual, upper triangle, shape (H + 1, H + 1).
        counts: Neurons of each kind, H together.
    """
    G, g, _ = gram_parts(gram, len(gram) - 1)
    energy = np.diag(G)
    if not energy.any():
        return np.zeros(len(g))
    ends = np.cumsum([0, *counts])
    usual = np.repeat([energy[a:b].mean() for a, b in pairwise(ends)], counts)
    found, visited = np.zeros(len(g)), energy > VISITED * usual
    found[visited] = np.linalg.solve(
        G[np.ix_(visited, visited)] + np.diag(RIDGE * usual[visited]), g[visited]
    )
    return found


def unknown_of(healthy: HealthyArm, j: int, settings: MonitorSettings) -> Unknown:
    """Return the neurons of a joint over the range of the healthy runs.

    Args:
        healthy: What is known of the healthy arm.
        j: The joint's index.
        settings: How many there are.
    """
    ranges = healthy.position_range[:, j], healthy.velocity_range[:, j]
    joint = healthy.nominal.robot.joints[j]
    return neurons_over(joint, *ranges, settings.neurons, settings.velocity_neurons)


class Approximator(Stateful):
    """The neurons of one joint: they learn from a detection on, and are used where no known effect fits.

    Args:
        j: The joint's index.
        observer: Filters the neurons and collects their normal equations.
        unknown: The neurons.
    """

    STATE = ("_looks_without",)

    def __init__(self, j: int, observer: MomentumObserver, unknown: Unknown) -> None:
        self.j, self.observer, self.unknown = j, observer, unknown
        self._looks_without = 0

    @property
    def term(self) -> Term:
        """The learned torque as an effect."""
        return Term(self.unknown, tuple(self.observer.state.weights[self.j]))

    def start(self) -> None:
        """Start to learn, or go on."""
        if not self.observer.state.learning[self.j]:
            self.observer.start_learning(self.j)

    def stop(self) -> None:
        """Forget what was learned."""
        self.observer.stop_learning(self.j)

    def believe(self) -> None:
        """Use the torque as learned so far."""
        self._set(weights(self.observer.state.neuron_gram[self.j], self.unknown.counts))

    def disbelieve(self) -> None:
        """Use no learned torque; the normal equations stay, in case that no known effect holds."""
        self._set(0.0)

    def is_cleared(self) -> bool:
        """Return whether the learned torque has stayed away where it would show; call it at every look."""
        o = self.observer
        learned, threshold = float(o.state.learned[self.j]), o.threshold[self.j]
        if abs(learned) > VISIBLE * threshold:
            self._looks_without = self._looks_without + 1 if abs(o.residual[self.j]) < threshold else 0
        if self._looks_without * o.settings.decide_every < CLEARED_AFTER:
            return False
        self._looks_without = 0
        return True

    def _set(self, w: Array | float) -> None:
        self.observer.state.weights[self.j] = w
        self.observer.refresh(self.j)
