"""How large a fault is: its torque along a motion, as a share of the torque that the joint carries anyway."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.faults import Fault, Step, mechanism
from benchmarks.plant.motion import Motion
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.simulate import Response, encoder_offset

Array = NDArray[np.float64]

BUSY = 0.05  # a joint counts if it carries this share of the largest joint torque, RMS
# Beyond these the effect is no longer one that a working robot would have.
LARGEST = {"offset_encoder": 0.1, "delay": 0.02, "tilt_x": 1.5, "tilt_y": 1.5}  # [rad], [s], [m/s²]
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
        a = np.empty_like(self.a)
        for k, t in enumerate(self.time):
            x.t, x.command = float(t), self.torque[k]
            x.q[:], x.v[:] = self.q[k], self.v[k]
            a[k] = respond(x)
        return self.plant.nominal.inverse_dynamics(self.q, self.v, a) - self.torque

    def share(self, fault: Fault) -> float:
        """Return the fault's torque, RMS, as a share of the joint's; the largest one among busy joints."""
        f = _rms(self.torque_of(fault))
        counted = self.rms >= BUSY * self.rms.max()
        if fault.joints:
            counted = np.array([j in fault.joints for j in self.plant.joints])
        if fault.effect == "link_inertia":  # felt from its joint down to the base
            counted = self.rms >= BUSY * self.rms.max()
        return float(np.max(f[counted] / np.maximum(self.rms[counted], 1e-9)))

    def sized(self, fault: Fault, share: float) -> Fault:
        """Return the fault scaled to a share [1], three digits, no larger than a working robot would have."""
        for _ in range(4):
            now = self.share(fault)
            if now <= 0:
                raise ValueError(f"{fault} has no torque along this motion")
            fault = _limited(fault.scaled(share / now))
        return _rounded(fault)


def _rms(signal: Array) -> Array:
    return np.sqrt(np.mean(signal**2, axis=0))


def _limited(fault: Fault) -> Fault:
    over = 1.0
    for name, value in fault.parameters.items():
        key = "offset_encoder" if (fault.effect, name) == ("encoder_offset", "offset") else name
        if key in LARGEST and isinstance(value, float):
            over = max(over, abs(value) / LARGEST[key])
    return fault.scaled(1.0 / over) if over > 1.0 else fault


def _rounded(fault: Fault) -> Fault:
    def three(value: object) -> object:
        if isinstance(value, float):
            return float(f"{value:.3g}")
        return tuple(float(f"{x:.3g}") for x in value) if isinstance(value, tuple) else value

    new = {k: three(v) for k, v in fault.parameters.items()}
    return Fault(fault.effect, joint=fault.joint, other=fault.other, after=fault.after, ramp=fault.ramp, **new)
