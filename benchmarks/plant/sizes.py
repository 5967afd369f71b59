"""How large a fault is: its torque along a motion, as a share of the torque that the joint carries anyway."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.faults import Fault, Step, Value, mechanism, scaled
from benchmarks.plant.motion import Motion
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.simulate import Response, encoder_offset

Array = NDArray[np.float64]

BUSY = 0.2  # a joint counts if it carries this share of the largest joint torque, RMS
# Beyond these the effect is no longer one that a working robot would have.
LARGEST = {
    ("encoder_offset", "offset"): 0.1,  # [rad]
    ("effort_delay", "delay"): 0.02,  # [s]
    ("base_tilt", "tilt_x"): 1.5,  # [m/s²]
    ("base_tilt", "tilt_y"): 1.5,
}
SAMPLES = 300


class Sizer:
    """Torque of faults along one nominal motion.

    Args:
        plant: The arm.
        motion: Kind of motion.
        duration: Its length [s].
        seed: Its seed.
    """

    def __init__(self, plant: MujocoPlant, motion: Motion, duration: float, seed: int) -> None:
        self.plant = plant
        self.time = np.linspace(0.0, duration, SAMPLES)
        plan = plant.plan(motion, duration, seed)
        self.q, self.v, self.a = plan(self.time)
        self.torque = plant.nominal.inverse_dynamics(self.q, self.v, self.a)
        soon = plan(self.time + 1e-3)
        self.torque_rate = (plant.nominal.inverse_dynamics(*soon) - self.torque) / 1e-3
        self.rms = _rms(self.torque)

    def busiest(self) -> tuple[str, ...]:
        """Return the joints by the torque they carry, largest first."""
        return tuple(self.plant.joints[j] for j in np.argsort(-self.rms))

    def beside(self, joint: str) -> str:
        """Return the busier neighbour of a joint, turning if it turns and sliding if it slides."""
        at, arm = self.plant.joints.index(joint), self.plant.nominal
        near = [k for k in (at - 1, at + 1) if 0 <= k < arm.n and arm.is_prismatic[k] == arm.is_prismatic[at]]
        return self.plant.joints[max(near, key=lambda k: self.rms[k])]

    def alike(self) -> tuple[str, str]:
        """Return the neighbours whose torques are most alike, so that what acts on both is seen on both."""
        straight, rms, joints = self.plant.nominal.is_prismatic, self.rms, self.plant.joints
        pairs = [
            k
            for k in range(len(joints) - 1)
            if straight[k] == straight[k + 1] and min(rms[k : k + 2]) > 0.005 * rms.max()
        ]
        best = max(pairs, key=lambda k: min(rms[k : k + 2]) / max(rms[k : k + 2]))
        return joints[best], joints[best + 1]

    def torque_of(self, fault: Fault) -> Array:
        """Return f = M q̈ + nle − τ of a fault along the motion [N·m or N], shape (N, n)."""
        mech = mechanism(fault)
        arm = self.plant.arm([mech])
        mech.present(1.0)
        if fault.effect == "effort_delay":
            columns = slice(None) if mech.j < 0 else slice(mech.j, mech.j + 1)
            out = np.zeros_like(self.torque)
            out[:, columns] = mech.p["delay"] * self.torque_rate[:, columns]
            return out
        if fault.effect == "encoder_offset":
            true = self.q + encoder_offset([mech], self.plant.nominal.n)
            return self.torque - self.plant.nominal.inverse_dynamics(true, self.v, self.a)
        respond, x = Response(arm, [mech]), Step.at_rest(self.q[0])
        out, full = np.empty_like(self.a), np.empty(arm.n)
        for k, t in enumerate(self.time):
            x.t, x.command = float(t), self.torque[k]
            x.q[:], x.v[:] = self.q[k], self.v[k]
            missed = np.zeros(arm.n)
            missed[arm.dofs] = respond(x) - self.a[k]
            # What the nominal torque fails to accelerate is f.
            mujoco.mj_mulM(arm.model, arm.data, full, missed)
            out[k] = full[arm.dofs]
        return out

    def share(self, fault: Fault) -> float:
        """Return the fault's torque, RMS, as a share of its joint's, or of the busy joint it loads most."""
        f = _rms(self.torque_of(fault))
        if (
            fault.joint is None or fault.effect == "link_inertia"
        ):  # a link is felt from its joint down to the base
            counted = self._busy()
        else:
            counted = np.array([j in fault.joints for j in self.plant.joints])
        return float(np.max(f[counted] / np.maximum(self.rms[counted], 1e-9)))

    def _busy(self) -> NDArray[np.bool_]:
        """Tell which joints carry much torque; forces are compared to forces."""
        straight = self.plant.nominal.is_prismatic
        largest = np.where(
            straight, self.rms[straight].max(initial=0.0), self.rms[~straight].max(initial=0.0)
        )
        return self.rms >= BUSY * largest

    def sized(self, fault: Fault, share: float) -> Fault:
        """Return the fault scaled to a share [1], three digits, no larger than a working robot would have."""
        for _ in range(4):
            now = self.share(fault)
            if now <= 0:
                raise ValueError(f"{fault} has no torque along this motion")
            fault = _limited(scaled(fault, share / now))
        if not self.share(fault) <= 1.5 * share:
            raise ValueError(f"{fault} cannot be given {share:g} of the joint's torque along this motion")
        return _rounded(fault)


def _rms(signal: Array) -> Array:
    return np.sqrt(np.mean(signal**2, axis=0))


def _limited(fault: Fault) -> Fault:
    over = 1.0
    for name, value in fault.parameters.items():
        if (fault.effect, name) in LARGEST and isinstance(value, float):
            over = max(over, abs(value) / LARGEST[fault.effect, name])
    return scaled(fault, 1.0 / over) if over > 1.0 else fault


def _rounded(fault: Fault) -> Fault:
    def three(value: Value) -> Value:
        if isinstance(value, float):
            return float(f"{value:.3g}")
        return tuple(float(f"{x:.3g}") for x in value) if isinstance(value, tuple) else value

    return fault.with_parameters({k: three(v) for k, v in fault.parameters.items()})
