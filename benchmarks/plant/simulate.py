"""The plant in time: controller, mechanisms and MuJoCo's forward dynamics in one loop.

Positions live at t_k, velocities halfway between (leapfrog); with h the step,

    a_k = forward dynamics at (q_k, v_k, τ_k)
    half += h a_k,   q_{k+1} = q_k + h half,   v_{k+1} = half + h/2 a_k

So the second difference of the positions around t_k is exactly the acceleration that the torque recorded at
t_k caused: holding the torque over a step adds no lag between position and torque. What is left is of second
order in h. MuJoCo's own integrators are of first order in this (Euler: velocities lag by h/2), or cost four
times as much.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.arm import Arm
from benchmarks.plant.faults import Mechanism, Step
from benchmarks.plant.faults.sensing import EncoderOffset
from benchmarks.plant.motion import Reference

Array = NDArray[np.float64]

FASTEST = 100.0  # [rad/s or m/s], beyond which the simulation has diverged
POSITION, NOTHING = int(mujoco.mjtStage.mjSTAGE_POS), int(mujoco.mjtStage.mjSTAGE_NONE)


class Gains(NamedTuple):
    """Feedback on top of the nominal torque, shape (n,) each.

    Attributes:
        stiffness: Torque per position error [N·m/rad or N/m].
        damping: Torque per velocity error [N·m·s/rad or N·s/m].
    """

    stiffness: Array
    damping: Array


class Simulated(NamedTuple):
    """What happened at every step of the log's time, shape (K, n) each, without noise.

    Attributes:
        q: True positions [rad or m].
        v: True velocities [rad/s or m/s].
        a: True accelerations [rad/s² or m/s²].
        command: Commanded torques [N·m or N].
    """

    q: Array
    v: Array
    a: Array
    command: Array


def simulate(
    arm: Arm,
    mechanisms: Sequence[Mechanism],
    reference: Reference,
    feedforward: Array,
    gains: Gains,
    *,
    step: float,
    settle: int,
) -> Simulated:
    """Run the plant along a reference given at every step; the log begins after `settle` of them.

    Args:
        arm: The compiled arm, mechanisms attached.
        mechanisms: The faults at work.
        reference: Desired motion, (K, n).
        feedforward: Torque of the nominal model for it [N·m or N], (K, n).
        gains: Feedback of the controller.
        step: Integration step h [s].
        settle: Number of steps before the log begins.

    Raises:
        FloatingPointError: If the motion diverges.
    """
    count, n = reference.q.shape
    out = Simulated(*(np.empty((count, n)) for _ in range(4)))
    offset = encoder_offset(mechanisms, n)
    respond = Response(arm, mechanisms)
    amounts = {mech: mech.fault.share(-settle * step) for mech in mechanisms}
    for mech, amount in amounts.items():
        mech.present(amount)
    changing = [mech for mech, amount in amounts.items() if amount < 1.0 or mech.fault.until < np.inf]
    x = Step.at_rest(reference.q[0] + offset)
    q, v, half = x.q, x.v, np.zeros(n)  # mechanisms see the arrays that are integrated
    for k in range(count):
        x.t = (k - settle) * step
        for mech in changing:
            if amounts[mech] != (amount := mech.fault.share(x.t)):
                mech.present(amount)
                amounts[mech] = amount
        error = reference.q[k] + offset - q
        x.command = feedforward[k] + gains.stiffness * error + gains.damping * (reference.v[k] - v)
        a = respond(x)
        out.q[k], out.v[k], out.a[k], out.command[k] = q, v, a, x.command
        half += step * a
        q += step * half
        v[:] = half + 0.5 * step * a
    if not np.isfinite(q).all() or np.abs(out.v).max() > FASTEST:
        raise FloatingPointError(f"the plant diverged with {', '.join(str(k.fault) for k in mechanisms)}")
    return Simulated(*(s[settle:] for s in out))


class Response:
    """Acceleration of the arm under a command, with the faults at work.

    Args:
        arm: The compiled arm, mechanisms attached.
        mechanisms: The faults.
    """

    def __init__(self, arm: Arm, mechanisms: Sequence[Mechanism]) -> None:
        self.arm = arm
        # What reaches the joint must be known to the mechanisms that depend on it.
        self.mechanisms = sorted(mechanisms, key=lambda k: k.name != "actuator_gain")
        self.moving = [k for k in mechanisms if k.moving]

    def __call__(self, x: Step) -> Array:
        """Return q̈ [rad/s² or m/s²] at positions, velocities and command of the step, shape (n,)."""
        m, d, dofs = self.arm.model, self.arm.data, self.arm.dofs
        x.delivered = x.command.copy()
        x.force[:] = 0.0
        x.loss[:] = 0.0
        for mech in self.mechanisms:
            mech.act(x)
        d.qpos[dofs] = x.q
        d.qvel[dofs] = x.v
        m.dof_frictionloss[dofs] = x.loss
        if self.moving:
            mujoco.mj_fwdPosition(m, d)
            for mech in self.moving:
                mech.act_moving(x)
        d.qfrc_applied[dofs] = x.delivered + x.force
        mujoco.mj_forwardSkip(m, d, POSITION if self.moving else NOTHING, 1)
        return d.qacc[dofs]


def controller_gains(arm: Arm, q: Array, feedforward: Array, effort: Array, step: float) -> Gains:
    """Return gains that hold the arm to some hundredths of a radian under a usual fault, and stay stable.

    Args:
        arm: The nominal arm.
        q: Some positions of the motion, (N, n).
        feedforward: Torque of the nominal model along the motion, (K, n).
        effort: Largest torque of each joint, infinite where unknown, (n,).
        step: Integration step [s].
    """
    mass = [arm.mass_matrix(row) for row in q]
    carried = np.mean([np.diag(M) for M in mass], axis=0)
    free = np.min([1 / np.diag(np.linalg.inv(M)) for M in mass], axis=0)  # inertia with the other joints free
    usual = np.where(np.isfinite(effort), 0.05 * effort, feedforward.std(axis=0))  # [N·m] to hold to 0.05 rad
    stiffness = np.minimum(np.maximum(25.0**2 * carried, usual / 0.05), (0.2 / step) ** 2 * free)
    damping = np.minimum(1.6 * np.sqrt(stiffness * carried), 0.25 * free / step)
    return Gains(stiffness, damping)


def encoder_offset(mechanisms: Sequence[Mechanism], n: int) -> Array:
    """Return q − q_read of every joint [rad or m], shape (n,)."""
    offset = np.zeros(n)
    for mech in mechanisms:
        if isinstance(mech, EncoderOffset):
            offset[mech.j] += mech.p["offset"]
    return offset
