"""The momentum observer [DeLuca2005]: the filters of all joints, advanced by one compiled call a tick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import prototype
from cdia_pin.diagnosis.codes import BAD
from cdia_pin.diagnosis.compiled import compile_bank, python_columns
from cdia_pin.diagnosis.layout import allocate, layout
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.effects import JointEffect, Signal, Unknown

Array = NDArray[np.float64]

FORGOTTEN = 4.0  # time constants of the filter after which a step is in the past
LASTING = 5.0  # times as long as a decision remembers, what is unknown is learned from
RESTING = 5.0  # widths of sgn, below which a joint may rest
CREEPING = 0.03  # [1], share of a joint's largest speed below which it may rest
NARROWEST = 1e-3  # [rad/s or m/s], over which sgn is smoothed where velocities have no noise


class Observer:
    """Residuals, thresholds, filtered columns and normal equations of all joints.

    Args:
        nominal: The healthy arm.
        effects: Effects whose columns are filtered, on any joint: those of the bank first.
        settings: Bandwidth, memory and the like.
        dt: Usual time between ticks [s].
        unknown: Neurons of each joint; a few around zero if omitted.
        bandwidth: γ of each joint [1/s], shape (n,); that of the settings if omitted.
    """

    def __init__(
        self,
        nominal: Nominal,
        effects: tuple[JointEffect, ...],
        settings: MonitorSettings,
        dt: float,
        unknown: Sequence[Unknown] | None = None,
        bandwidth: Array | None = None,
    ) -> None:
        from cdia_pin.diagnosis import kernels

        self.nominal, self.settings, self.dt = nominal, settings, dt
        self.k = kernels
        n = nominal.robot.n
        own = [prototype(t.effect, nominal.robot) for t in nominal.of_joints]  # type: ignore[arg-type]
        self.effects = effects + tuple(e for e in dict.fromkeys(own) if e not in effects)
        self.ends = np.cumsum([0, *(e.size for e in self.effects)])
        unknown = unknown or [Unknown(joint=joint) for joint in nominal.robot.joints]
        parts = layout(n, self.effects, len(unknown[0].position_centres))
        self._compiled = compile_bank(self.effects, parts)
        self._state, views = allocate(parts)
        self.joint, self.columns, self.gram = views["joint"], views["columns"], views["gram"]
        self.absent, self.neurons, self.neuron_gram = views["absent"], views["neurons"], views["neuron_gram"]
        self._scalars, self._mass, self._phi = views["scalars"], views["mass"], views["phi"]
        views["centres"][:] = [
            np.transpose([u.position_centres for u in unknown]),
            np.transpose([u.velocity_centres for u in unknown]),
        ]
        views["widths"][:] = [[u.position_width for u in unknown], [u.velocity_width for u in unknown]]
        signals = [e.traits.depends_on for e in self.effects]
        self._smooth = self._columns_of([Signal.ACCELERATION in s for s in signals])
        self._driven = self._columns_of(
            [Signal.TORQUE in s and Signal.ACCELERATION not in s for s in signals]
        )
        self.columns[kernels.PRESENT] = 1.0
        self.joint[kernels.BANDWIDTH] = settings.bandwidth if bandwidth is None else bandwidth
        self.joint[kernels.BOUND] = np.inf
        self.idle_ticks = max(1.0, settings.gone_after / dt)
        self._scalars[kernels.FORGET] = np.exp(-dt / settings.memory)
        self._scalars[kernels.REMEMBER] = np.exp(-dt * kernels.SELDOM / (LASTING * settings.memory))
        self._scalars[kernels.DEBOUNCE] = settings.debounce
        self._scalars[kernels.IDLE] = self.idle_ticks
        self._scalars[kernels.FLOOR] = settings.gain_floor
        for term, kind in zip(nominal.of_joints, own, strict=True):
            at = self.effects.index(kind)
            j = nominal.robot.joint_index(term.effect.scope[0])
            self.columns[kernels.KNOWN, j, self.ends[at] : self.ends[at + 1]] += term.theta
        # Rows and parts that are read at every tick.
        self.residual = self.joint[kernels.RESIDUAL]  # filtered torque that the model lacks [N·m or N], (n,)
        self.threshold = self.joint[kernels.THRESHOLD]  # its bound on a healthy arm [N·m or N], (n,)
        self.remainder = self.joint[kernels.REMAINDER]  # residual less what is believed [N·m or N], (n,)
        self.addition = self.joint[kernels.ADDITION]  # what to add to a nominal torque [N·m or N], (n,)
        self.bandwidth = self.joint[kernels.BANDWIDTH]  # γ [1/s], (n,)
        self.q, self.v = self.joint[kernels.POSITION], self.joint[kernels.VELOCITY]  # of the last tick, (n,)
        self.believed = self.columns[kernels.BELIEVED]  # parameters of the faults believed in, (n, P)
        self.filtered = self.columns[kernels.FILTERED]  # filtered columns y, (n, P)
        self.inertial = False  # is an effect of acceleration believed in?
        self.use_width(np.full(n, NARROWEST))
        self.reset()

    def _columns_of(self, chosen: Sequence[bool]) -> NDArray[np.bool_]:
        return np.repeat(chosen, np.diff(self.ends)).astype(bool)

    def reset(self) -> None:
        """Forget the past, keeping bounds and beliefs; the next tick starts the filters."""
        k = self.k
        past = [
            k.RESIDUAL,
            k.THRESHOLD,
            k.REMAINDER,
            k.EXCEEDED,
            k.LEARNED,
            k.AMPLITUDE,
            k.MOVING,
            k.ADDITION,
            k.WEIGHT,
        ]
        self.joint[past] = 0.0
        self.columns[[k.PHI, k.FILTERED]] = 0.0
        self.gram[:] = 0.0
        self.absent[:] = 0.0
        self.neurons[[k.ACTIVATION, k.ACTIVATED]] = 0.0
        self._scalars[k.COUNT] = 0.0  # of ticks: which of them look at the neurons
        self.time = -np.inf

    def step(self, t: float, q: Array, v: Array, tau: Array) -> int:
        """Advance by one tick.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            tau: Torque since the last tick [N·m or N], shape (n,).

        Returns:
            What needs attention, see `kernels`.
        """
        M, nle = self.nominal.robot.rigid_terms(q, v)
        if self.time == -np.inf:
            return self._begin(t, q, v, tau, M, nle)
        if self._compiled.in_python or self.nominal.others.terms:
            self._evaluate_in_python(t, q, v, (v - self.v) / (t - self.time), tau)
        asks = int(self._compiled.tick(self._state, q, v, tau, M, nle, t))
        if not asks & BAD:
            self.time = t
        return asks

    def _begin(self, t: float, q: Array, v: Array, tau: Array, M: Array, nle: Array) -> int:
        if not np.isfinite([q, v, tau]).all():
            return BAD
        self.time = self._scalars[self.k.TIME] = t
        self.q[:], self.v[:], self.joint[self.k.NLE], self._mass[:] = q, v, nle, M
        if self.effects:
            sign = np.tanh(v / self.joint[self.k.WIDTH])
            still = np.zeros_like(q)
            phi = [python_columns(e, q, v, still, tau, sign, t) for e in self.effects]
            self.columns[self.k.PHI] = np.concatenate(phi, axis=1)
        return 0

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque that makes the arm answer as a healthy one would to ``tau`` [N·m or N], shape (n,)."""
        direction = self.v if v_desired is None else v_desired
        a = self._asked(tau) if self.inertial else np.zeros_like(tau)
        self._fill_corrections(direction, a, tau)
        return np.asarray(self._compiled.corrected(self._state, direction, a, tau, True))

    def _asked(self, tau: Array) -> Array:
        """Return the acceleration that a healthy arm would have under a torque, shape (n,)."""
        return np.asarray(np.linalg.solve(self._mass, tau - self.joint[self.k.NLE]))

    def correct_from_now(self, on: bool) -> None:
        """Say whether `addition` is worked out at every tick."""
        self._scalars[self.k.CORRECTS] = float(on)
        if not on:
            self.addition[:] = 0.0

    def believe(self, j: int, theta: Array) -> None:
        """Set the parameters of the faults believed in on a joint, zero for the others, shape (p,), p ≤ P."""
        self.believed[j] = 0.0
        self.believed[j, : len(theta)] = theta
        self.refresh(j)
        self.inertial = bool(self.believed[:, self._smooth].any())
        self._scalars[self.k.DRIVEN] = float(self.believed[:, self._driven].any())

    def refresh(self, j: int) -> None:
        """Work out anew what is left of a joint's residual, after a belief or the weights of neurons have changed."""
        k = self.k
        learned = self.neurons[k.WEIGHTS, j] @ self.neurons[k.ACTIVATED, j]
        self.joint[k.LEARNED, j] = learned
        self.remainder[j] = self.residual[j] - self.believed[j] @ self.filtered[j] - learned

    def use_width(self, width: Array) -> None:
        """Set the speed over which sgn is smoothed [rad/s or m/s], shape (n,)."""
        self.joint[self.k.WIDTH] = np.maximum(width, NARROWEST)
        self.joint[self.k.SOFT] = np.maximum(self.settings.soft_sign, self.joint[self.k.WIDTH])
        self.joint[self.k.REST] = RESTING * self.joint[self.k.WIDTH]

    def use_speed(self, fastest: Array) -> None:
        """Set the largest speed of each joint [rad/s or m/s], shape (n,): what is slow beside it may be at rest."""
        self.joint[self.k.REST] = np.maximum(RESTING * self.joint[self.k.WIDTH], CREEPING * fastest)

    def restart_decision(self, j: int) -> None:
        """Begin the normal equations of a joint anew, once the filter has forgotten how the fault came in."""
        self.gram[j] = 0.0
        self.joint[self.k.WEIGHT, j] = 0.0
        self.joint[self.k.WATCHED, j] = -np.ceil(FORGOTTEN / (self.bandwidth[j] * self.dt))

    def end_decision(self, j: int) -> None:
        """Stop collecting normal equations for a joint."""
        self.joint[self.k.WATCHED, j] = 0.0

    def start_learning(self, j: int) -> None:
        """Begin to learn an unknown fault of a joint."""
        self.neurons[:, j] = 0.0
        self.neuron_gram[j] = 0.0
        self.joint[self.k.LEARNING, j] = 1.0
        self._scalars[self.k.LEARNS] = 1.0

    def stop_learning(self, j: int) -> None:
        """Forget what was learned of a joint."""
        self.neurons[:, j] = 0.0
        self.joint[[self.k.LEARNING, self.k.LEARNED], j] = 0.0
        self._scalars[self.k.LEARNS] = float(self.joint[self.k.LEARNING].any())

    # ------------------------------------------------------------- what numba cannot compile

    def _evaluate_in_python(self, t: float, q: Array, v: Array, a: Array, tau: Array) -> None:
        width = self.joint[self.k.WIDTH]
        sign = np.tanh(v / width)
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            self._phi[0][span] = python_columns(self.effects[i], q, v, a, tau, sign, t)
        if self.nominal.others.terms:
            self.joint[self.k.OUTSIDE] = self.nominal.outside(q, v, a, tau, t, width)
        self._fill_corrections(v, np.zeros_like(a), tau)

    def _fill_corrections(self, direction: Array, a: Array, tau: Array) -> None:
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            sign = np.tanh(direction / self.joint[self.k.SOFT])
            for phi, effort in ((self._phi[1], np.zeros_like(tau)), (self._phi[2], tau)):
                phi[span] = python_columns(self.effects[i], self.q, self.v, a, effort, sign, self.time)
