"""How large a fault is along a motion, and on which joints it can be seen at all."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.online.faults import FastViscousFriction, resized
from benchmarks.online.motions import Onward
from benchmarks.online.sensors import Sensors
from benchmarks.plant.faults import Fault
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.sizes import SAMPLES, Sizer

Array = NDArray[np.float64]

BANDWIDTH = 20.0  # [1/s], of the momentum residual in which a fault should stand out of the sensors' noise
VISIBLE = 3.0  # standard deviations of that noise
IDLE = (
    5e-3  # a joint that carries less than this share of its effort limit [1] has no torque to take shares of
)
LIGHTEST = 1e-3  # the same of the largest joint torque, where the URDF states no limit [1]
HEAVIEST_ROTOR = 1.0  # as a share of the inertia that the joint carries anyway [1]
MOST_PUSHED = 0.5  # of the usual controller's damping [1], which a fault that feeds energy may take away
DAMPING = 40.0  # [1/s], of that controller
TURN = 2 * np.pi  # [rad] of a ripple's phase; a motion that passes through less shows a spring


class OnlineSizer(Sizer):
    """Torque of faults along one nominal motion, from the time on at which they begin.

    Args:
        plant: The arm as its file describes it.
        duration: Length of the motion [s].
        seed: Its seed.
        begin: From when on it is looked at [s].
    """

    def __init__(self, plant: MujocoPlant, duration: float, seed: int, begin: float) -> None:
        super().__init__(plant, Onward(), duration, seed)
        self.time = np.linspace(begin, duration, SAMPLES)
        self.q, self.v, self.a = plant.plan(Onward(), duration, seed)(self.time)
        self.torque = plant.nominal.inverse_dynamics(self.q, self.v, self.a)
        self.rms = np.sqrt(np.mean(self.torque**2, axis=0))
        mass = np.array([plant.nominal.mass_matrix(q) for q in self.q[::20]])
        self.carried = np.einsum("kii->ki", mass).mean(axis=0)  # [kg·m² or kg]
        self.free = 1 / np.linalg.inv(mass).diagonal(axis1=1, axis2=2).max(
            axis=0
        )  # the other joints free, least
        self.noise = residual_noise(plant, mass)
        limit, straight = plant.robot.limits.effort, plant.robot.is_prismatic
        largest = np.where(
            straight, self.rms[straight].max(initial=0.0), self.rms[~straight].max(initial=0.0)
        )
        self.loaded = self.rms > np.where(np.isfinite(limit), IDLE * limit, LIGHTEST * largest)

    def torque_of(self, fault: Fault) -> Array:
        """Return f of a fault along the motion [N·m or N], shape (N, n)."""
        if fault.effect != FastViscousFriction.name:
            return super().torque_of(fault)
        everywhere = Fault("viscous_friction", joint=fault.joint, coefficient=_number(fault, "coefficient"))
        fast = np.abs(self.v) > _number(fault, "speed")
        return np.where(fast, super().torque_of(everywhere), 0.0)

    def sized(self, fault: Fault, share: float) -> Fault:
        """Return the fault scaled to a share of its joint's torque, RMS over RMS [1], to three digits."""
        for _ in range(8):
            now = self.share(fault)
            if not now > 0:
                raise ValueError(f"{fault} has no torque along this motion")
            if abs(now / share - 1) < 2e-3:
                break
            fault = resized(fault, share / now)
        return fault.with_parameters(
            {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in fault.parameters.items()}
        )

    def shows(self, fault: Fault, share: float) -> bool:
        """Tell whether a fault of a share of its joint's torque [1] is one that a sensor could see.

        The joint carries a load, and the fault stands out of the noise. A rotor must not weigh more than what
        the joint carries, the motion must go through a period of a ripple and through the speeds at which a fault
        is there, and what feeds energy to the joint must leave the usual controller stable.
        """
        assert fault.joint is not None
        j = self.plant.joints.index(fault.joint)
        if not self.loaded[j] or share * self.rms[j] < VISIBLE * self.noise[j]:
            return False
        needs = _NEEDS.get(fault.effect)
        return needs is None or needs(self, fault, share, j)


# What some faults need of a motion, beside a joint that carries a load: (sizer, fault, share, joint) to whether.


def _rotor_is_light(look: OnlineSizer, fault: Fault, share: float, j: int) -> bool:
    inertia = share * look.rms[j] / np.sqrt(np.mean(look.a[:, j] ** 2))
    return bool(inertia <= HEAVIEST_ROTOR * look.carried[j])


def _goes_through_a_period(look: OnlineSizer, fault: Fault, share: float, j: int) -> bool:
    return bool(_number(fault, "frequency") * np.ptp(look.q[:, j]) >= TURN)


def _stays_stable(look: OnlineSizer, fault: Fault, share: float, j: int) -> bool:
    coefficient = share / look.share(fault) * _number(fault, "coefficient")
    stable = coefficient < MOST_PUSHED * DAMPING * look.free[j]
    return bool(stable and _goes_through_a_period(look, fault, share, j))


def _meets_the_bump(look: OnlineSizer, fault: Fault, share: float, j: int) -> bool:
    away = np.abs(np.abs(look.v[:, j]) - _number(fault, "speed"))
    return bool(np.mean(away < _number(fault, "width")) > 0.1)


def _is_fast_and_slow(look: OnlineSizer, fault: Fault, share: float, j: int) -> bool:
    return bool(0.1 < np.mean(np.abs(look.v[:, j]) > _number(fault, "speed")) < 0.8)


_NEEDS = {
    "rotor_inertia": _rotor_is_light,
    "position_ripple": _goes_through_a_period,
    "speed_cogging": _stays_stable,
    "speed_bump": _meets_the_bump,
    FastViscousFriction.name: _is_fast_and_slow,
}


def _number(fault: Fault, parameter: str) -> float:
    value = fault.parameters[parameter]
    assert isinstance(value, float)
    return value


def residual_noise(plant: MujocoPlant, mass: Array) -> Array:
    """Return the noise of a first-order momentum residual at 1 kHz with the usual sensors [N·m or N], (n,).

    From white noise of the velocities: (1 − E)/Δ √(2/(1 + E)) ‖M_j σ_v‖ with E = exp(−γ Δ).

    Args:
        plant: The arm.
        mass: Mass matrices along the motion, (N, n, n).
    """
    sensors, tick = Sensors(), 1e-3
    std = sensors.velocity_stds(plant.robot.is_prismatic)
    assert std is not None
    keep = np.exp(-BANDWIDTH * tick)
    return (1 - keep) / tick * np.sqrt(2 / (1 + keep) * np.mean(((mass * std) ** 2).sum(axis=-1), axis=0))


@lru_cache(maxsize=64)
def sizer(robot: str, duration: float, seed: int, begin: float) -> OnlineSizer:
    """Return the sizer of one arm and motion; the same one each time."""
    return OnlineSizer(nominal(robot), duration, seed, begin)


@lru_cache(maxsize=8)
def nominal(robot: str) -> MujocoPlant:
    """Return an arm of the catalogue as its file describes it; the same one each time."""
    return MujocoPlant(robot)
