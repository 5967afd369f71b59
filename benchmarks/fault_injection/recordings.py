"""Runs of healthy arms on which a real fault begins late; bad samples are put into them before that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.online.control import NominalControl
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.scenarios import BEGIN, singles
from benchmarks.online.trial import SEED, healthy_runs, log_of
from benchmarks.plant.faults import Fault
from cdia_pin.logs import Log

Array = NDArray[np.float64]

FAULT_AT, LENGTH = 6.5, 8.5  # [s], begin of the real fault and end of a run
SHARE = 0.5  # [1], RMS of the fault's torque over that of its joint's
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
        fault: Name of the real fault, with its joint.
    """

    joints: tuple[str, ...]
    samples: Samples
    fault: str


@lru_cache(maxsize=1)
def recordings(arm: str) -> tuple[tuple[Log, ...], tuple[Recording, ...]]:
    """Return the healthy runs of an arm that monitors learn from, and the recordings."""
    plant = OnlinePlant(arm, seed=SEED)
    learned = tuple(log_of(run) for run in healthy_runs(plant))
    return learned, tuple(_record(plant, arm, k) for k in range(MOTIONS))


def _record(plant: OnlinePlant, arm: str, number: int) -> Recording:
    cases = singles(arm, SHARE, ("coulomb_friction",), MOTIONS)
    case = cases[number % len(cases)]
    faults = tuple(_later(f) for f in case.faults)
    control = NominalControl(plant.robot)
    run = replace(case, faults=faults, duration=LENGTH, seed=case.seed + number).run(plant, control)
    tau = np.vstack([np.zeros_like(run.command[:1]), run.command[:-1]])
    assert run.v_measured is not None
    samples = Samples(run.time, run.q_measured, run.v_measured, tau, run.command, run.reference.v)
    return Recording(run.joints, samples, ", ".join(map(str, faults)))


def _later(fault: Fault) -> Fault:
    """Return a fault that begins as much later as the bad samples need."""
    assert fault.after == BEGIN
    return Fault(fault.effect, joint=fault.joint, after=FAULT_AT, **fault.parameters)
