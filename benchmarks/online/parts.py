"""What each of several faults adds to their common torque."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.online.faults import mechanism
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.run import OnlineRun
from benchmarks.plant.faults import Fault, Step
from benchmarks.plant.simulate import Response

Array = NDArray[np.float64]


def torque_of(plant: OnlinePlant, run: OnlineRun, fault: Fault) -> Array:
    """Return the torque of one fault along a run that may have had several [N·m or N], shape (K, n).

    With the fault alone, the torque that arrived would have accelerated the arm by a₁ where it was accelerated
    by a: f₁ = f + M₁ (a₁ − a). The parts add up to the whole where each depends on position, speed and command
    alone; a joint that sticks, and friction by load beside a weak motor, are shared as MuJoCo finds it.
    """
    mech = mechanism(fault)
    arm = plant.arm([mech])
    respond, x = Response(arm, [mech]), Step.at_rest(run.q[0])
    out, full, amount = run.fault_torque.copy(), np.empty(arm.n), None
    for k, t in enumerate(run.time.tolist()):
        if (now := fault.share(t)) != amount:
            mech.present(now)
            amount = now
        x.t, x.command = t, run.arrived[k]
        x.q[:], x.v[:] = run.q[k], run.v[k]
        missed = respond(x) - run.a[k]
        mujoco.mj_mulM(arm.model, arm.data, full, missed)
        out[k] += full
    return out
