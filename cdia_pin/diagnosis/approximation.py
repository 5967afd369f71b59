"""A fault that no known effect explains, learned as radial bases in q and q̇ and a torque neuron ([Thesis] eq. 3.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.isolation import symmetric
from cdia_pin.diagnosis.learning import Healthy
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.effects import Term, Unknown

Array = NDArray[np.float64]

WIDEST = 10.0  # [rad or m, and per s], range of a signal that nothing limits
RIDGE = 1e-3  # [1], of the weights, relative to the mean energy of their columns: keeps them bounded
VISIBLE = 2.0  # [1], torque of the neurons over the threshold, above which it would be missed
GONE = 0.6  # [s] without it, where it would show, after which it is dropped


def neurons_of(joint: str, reach: Array, count: int) -> Unknown:
    """Return neurons spread over what a joint does.

    Args:
        joint: Name of the joint.
        reach: Smallest and largest position, then velocity, shape (2, 2).
        count: Neurons in position, and in velocity.
    """
    (q0, q1), (v0, v1) = np.clip(reach, -WIDEST, WIDEST)
    q = np.linspace(q0, max(q1, q0 + 1e-3), max(count, 2))
    v = np.linspace(v0, max(v1, v0 + 1e-3), max(count, 2))
    return Unknown(
        joint=joint,
        position_centres=tuple(q.tolist()),
        velocity_centres=tuple(v.tolist()),
        position_width=float(1.5 * (q[1] - q[0])),
        velocity_width=float(1.5 * (v[1] - v[0])),
    )


def weights(gram: Array) -> Array:
    """Return the weights of the neurons that explain a residual, shape (p,).

    Args:
        gram: Gram matrix of the neurons and of what is left to them, upper triangle, shape (p + 1, p + 1).
    """
    full = symmetric(gram)
    G, g = full[:-1, :-1], full[:-1, -1]
    if not np.trace(G) > 0.0:
        return np.zeros(len(g))
    # one size of ridge for all: a neuron that has hardly been visited stays near zero
    return np.asarray(np.linalg.solve(G + RIDGE * np.trace(G) / len(g) * np.eye(len(g)), g))


def unknown_of(healthy: Healthy, j: int, count: int) -> Unknown:
    """Return the neurons of a joint over the reach of the healthy runs."""
    return neurons_of(healthy.nominal.robot.joints[j], healthy.reach[:, :, j], count)


class Approximator:
    """The neurons of one joint: they learn from a detection on, and are believed when nothing known is.

    Args:
        j: The joint.
        observer: Filters the neurons and collects their normal equations.
        unknown: The neurons.
    """

    def __init__(self, j: int, observer: Observer, unknown: Unknown) -> None:
        self.j, self.observer, self.unknown = j, observer, unknown
        self._away = 0

    @property
    def term(self) -> Term:
        """The torque that is believed."""
        return Term(self.unknown, tuple(self.observer.neurons[self.observer.k.WEIGHTS, self.j]))

    def start(self) -> None:
        """Begin to learn, or go on."""
        if not self.observer.joint[self.observer.k.LEARNING, self.j]:
            self.observer.start_learning(self.j)

    def stop(self) -> None:
        """Forget what was learned."""
        self.observer.stop_learning(self.j)

    def believe(self) -> None:
        """Believe what has been learned so far."""
        self._set(weights(self.observer.neuron_gram[self.j]))

    def disbelieve(self) -> None:
        """Believe no unknown torque; what has been learned stays, in case that nothing known holds."""
        self._set(0.0)

    def is_away(self) -> bool:
        """Look whether the torque that is believed is there; tell if it has stayed away where it would show."""
        o = self.observer
        learned, threshold = float(o.joint[o.k.LEARNED, self.j]), o.threshold[self.j]
        if abs(learned) > VISIBLE * threshold:
            self._away = self._away + 1 if abs(o.residual[self.j]) < threshold else 0
        if self._away * o.settings.decide_every < GONE:
            return False
        self._away = 0
        return True

    def _set(self, w: Array | float) -> None:
        self.observer.neurons[self.observer.k.WEIGHTS, self.j] = w
        self.observer.refresh(self.j)
