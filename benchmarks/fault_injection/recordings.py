"""Runs of healthy arms; bad samples are put into them, and later a real fault."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.online.control import NominalControl
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.scenarios import healthy
from benchmarks.online.trial import SEED, healthy_runs, log_of
from cdia_pin.logs import Log

Array = NDArray[np.float64]

FAULT_AT, LENGTH = 3.6, 4.6  # [s], begin of the real fault and end of a run
SIZE = 4.0  # [1], friction over the bound of a healthy residual, which differs between engines
SIGN_WIDTH = 0.01  # [rad/s or m/s], over which friction turns its sign
MOTIONS = 2  # recordings of each arm


@dataclass(frozen=True, eq=False)
class Samples:
    """What a loop gives to a monitor, tick by tick: K ticks of n joints.

    Attributes:
        t: Times [s], shape (K,).
        q: Positions [rad or m], shape (K, n).
        v: Velocities [rad/s or m/s], shape (K, n).
        tau: Torque since the tick before [N·m or N], shape (K, n).
        nominal: Torque that the controller wants to command [N·m or N], shape (K, n).
        desired: Desired velocities [rad/s or m/s], shape (K, n).
    """

    t: Array
    q: Array
    v: Array
    tau: Array
    nominal: Array
    desired: Array

    def rows(self, order: NDArray[np.intp]) -> Samples:
        """Return other rows, or the same ones in another order."""
        return Samples(*(s[order] for s in vars(self).values()))

    def copy(self) -> Samples:
        """Return a copy that may be spoiled."""
        return Samples(*(s.copy() for s in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Recording:
    """A run of an arm.

    Attributes:
        joints: Names of the joints.
        samples: What the loop gives.
        speed: True velocities [rad/s or m/s], shape (K, n).
    """

    joints: tuple[str, ...]
    samples: Samples
    speed: Array

    def with_friction(self, j: int, level: float, since: int) -> Samples:
        """Return the samples of an arm with dry friction, which its drive overcomes: the motion is the same.

        Args:
            j: Index of the joint.
            level: Level of the friction [N·m or N].
            since: Tick from which on it is there.
        """
        s = self.samples.copy()
        friction = level * np.tanh(self.speed[since:, j] / SIGN_WIDTH)
        s.nominal[since:, j] += friction
        s.tau[since + 1 :, j] += friction[:-1]
        return s


@lru_cache(maxsize=1)
def recordings(arm: str) -> tuple[tuple[Log, ...], tuple[Recording, ...]]:
    """Return the healthy runs of an arm that monitors learn from, and the recordings."""
    plant = OnlinePlant(arm, seed=SEED)
    learned = tuple(log_of(run) for run in healthy_runs(plant))
    return learned, tuple(_record(plant, arm, k) for k in range(MOTIONS))


def _record(plant: OnlinePlant, arm: str, number: int) -> Recording:
    case = healthy(arm, MOTIONS, LENGTH)[number]
    run = case.run(plant, NominalControl(plant.robot))
    tau = np.vstack([np.zeros_like(run.command[:1]), run.command[:-1]])
    assert run.v_measured is not None
    samples = Samples(run.time, run.q_measured, run.v_measured, tau, run.command, run.reference.v)
    return Recording(run.joints, samples, run.v)
