"""The momentum observer: state of the filters of all joints, advanced by one compiled call a tick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import prototype
from cdia_pin.diagnosis.compiled import compile_bank, python_columns
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.effects import JointEffect, Unknown

Array = NDArray[np.float64]

FORGOTTEN = 4.0  # time constants of the filter after which a step is in the past
LASTING = 5.0  # times as long as a decision remembers, what is unknown is learned from
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
        P = int(self.ends[-1])
        self._compiled = compile_bank(self.effects)
        sizes = [e.size for e in self.effects]
        self._interval = np.repeat([e.of_torque or e.of_acceleration for e in self.effects], sizes).astype(bool)
        self._smooth = np.repeat([e.of_acceleration for e in self.effects], sizes).astype(bool)
        self.joint = np.zeros((kernels.JOINT_ROWS, n))
        self.columns = np.zeros((kernels.COLUMN_ROWS, n, P))
        self.columns[kernels.PRESENT] = 1.0
        self.gram = np.zeros((n, P + 1, P + 1))
        self.absent = np.zeros((n, len(self.effects)))
        self.bandwidth = np.full(n, settings.bandwidth) if bandwidth is None else bandwidth
        unknown = unknown or [Unknown(joint=joint) for joint in nominal.robot.joints]
        self._centres = np.array([[u.position_centres for u in unknown], [u.velocity_centres for u in unknown]])
        self._centres = np.ascontiguousarray(self._centres.transpose(0, 2, 1))
        self._widths = np.array([[u.position_width for u in unknown], [u.velocity_width for u in unknown]])
        self.neurons = np.zeros((kernels.NEURON_ROWS, n, unknown[0].size))
        self.neuron_gram = np.zeros((n, unknown[0].size + 1, unknown[0].size + 1))
        self._learning = False
        self._mass = np.zeros((n, n))
        self._phi, self._phi0, self._phi1 = (np.zeros((n, P)) for _ in range(3))
        self._forget = float(np.exp(-dt / settings.memory))
        self._remember = float(np.exp(-dt / (LASTING * settings.memory)))
        self.idle_ticks = max(1.0, settings.gone_after / dt)
        self.joint[kernels.WIDTH] = NARROWEST
        self.joint[kernels.BOUND] = np.inf
        for term, kind in zip(nominal.of_joints, own, strict=True):
            at = self.effects.index(kind)
            j = nominal.robot.joint_index(term.effect.scope[0])
            self.columns[kernels.KNOWN, j, self.ends[at] : self.ends[at + 1]] += term.theta
        self._soft = np.maximum(settings.soft_sign, self.joint[kernels.WIDTH])
        self.reset()

    def reset(self) -> None:
        """Forget the past, keeping bounds and beliefs; the next tick starts the filters."""
        k = self.k
        self.joint[[k.RESIDUAL, k.THRESHOLD, k.REMAINDER, k.EXCEEDED, k.LEARNED, k.AMPLITUDE]] = 0.0
        self.columns[[k.PHI, k.FILTERED]] = 0.0
        self.gram[:] = 0.0
        self.joint[k.WEIGHT] = 0.0
        self.absent[:] = 0.0
        self.neurons[[k.ACTIVATION, k.ACTIVATED]] = 0.0
        self.time = -np.inf
        self.q = self.v = np.zeros(self.nominal.robot.n)

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
        k = self.k
        M, nle = self.nominal.robot.rigid_terms(q, v)
        dt = t - self.time
        if dt == np.inf:
            if not np.isfinite([q, v, tau]).all():
                return int(k.BAD)
            self.time, self.q, self.v = t, q, v
            self.joint[k.VELOCITY], self.joint[k.NLE] = v, nle
            self._mass[:] = M
            self.columns[k.PHI] = self._python_phi(q, v, np.zeros_like(q), tau)
            return 0
        if self._compiled.in_python or self.nominal.others.terms:
            self._evaluate_in_python(q, v, (v - self.joint[k.VELOCITY]) / dt, tau)
        asks = int(
            self._compiled.tick(
                self.joint, self.columns, self.gram, self.absent, self._mass, self._phi, self._interval, self.ends,
                self._centres, self._widths, self.neurons, self.neuron_gram, self._learning,
                q, v, tau, M, nle, dt, self.bandwidth, self._forget, self._remember,
                float(self.settings.debounce), self.idle_ticks,
            )
        )  # fmt: skip
        if not asks & k.BAD:
            self.time, self.q, self.v = t, q, v
        return asks

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque that makes the arm answer as a healthy one would to ``tau`` [N·m or N], shape (n,)."""
        return self._correction(tau, self.v if v_desired is None else v_desired, True)

    def addition(self, tau: Array) -> Array:
        """Return what to add to the nominal torque while ``tau`` acts [N·m or N], shape (n,)."""
        return self._correction(tau, self.v, False)

    def _correction(self, tau: Array, direction: Array, divide: bool) -> Array:
        a = self._asked(tau) if divide and self._inertial else np.zeros_like(tau)
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            sign = np.tanh(direction / self._soft)
            for phi, effort in ((self._phi0, np.zeros_like(tau)), (self._phi1, tau)):
                phi[span] = python_columns(self.effects[i], self.q, self.v, a, effort, sign, self.time)
        return np.asarray(
            self._compiled.correct(
                self.joint, self.columns, self._phi0, self._phi1, self._interval, self._smooth,
                self._centres, self._widths, self.neurons, self._learning, self.q, self.v, direction, a, tau,
                self._soft, self.settings.gain_floor, divide,
            )
        )  # fmt: skip

    @property
    def _inertial(self) -> bool:
        """Whether an effect of acceleration is believed in."""
        return bool(self.believed[:, self._smooth].any())

    def _asked(self, tau: Array) -> Array:
        """Return the acceleration that a healthy arm would have under a torque, shape (n,)."""
        return np.asarray(np.linalg.solve(self._mass, tau - self.joint[self.k.NLE]))

    def use_width(self, width: Array) -> None:
        """Set the speed over which sgn is smoothed [rad/s or m/s], shape (n,)."""
        self.joint[self.k.WIDTH] = np.maximum(width, NARROWEST)
        self._soft = np.maximum(self.settings.soft_sign, self.joint[self.k.WIDTH])

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
        self._learning = True

    def stop_learning(self, j: int) -> None:
        """Forget what was learned of a joint."""
        self.neurons[:, j] = 0.0
        self.joint[[self.k.LEARNING, self.k.LEARNED], j] = 0.0
        self._learning = bool(self.joint[self.k.LEARNING].any())

    # ------------------------------------------------------------- rows by name

    @property
    def residual(self) -> Array:
        """Filtered torque that the model lacks [N·m or N], shape (n,); a view."""
        return np.asarray(self.joint[self.k.RESIDUAL])

    @property
    def threshold(self) -> Array:
        """Bound of a healthy arm's residual [N·m or N], shape (n,); a view."""
        return np.asarray(self.joint[self.k.THRESHOLD])

    @property
    def remainder(self) -> Array:
        """Residual less what is believed [N·m or N], shape (n,); a view."""
        return np.asarray(self.joint[self.k.REMAINDER])

    @property
    def believed(self) -> Array:
        """Parameters of the faults believed in, zero for the others, shape (n, P); a view."""
        return np.asarray(self.columns[self.k.BELIEVED])

    @property
    def filtered(self) -> Array:
        """Filtered columns y, shape (n, P); a view."""
        return np.asarray(self.columns[self.k.FILTERED])

    # ------------------------------------------------------------- what numba cannot compile

    def _python_phi(self, q: Array, v: Array, a: Array, tau: Array) -> Array:
        if not self.effects:
            return self._phi
        sign = np.tanh(v / self.joint[self.k.WIDTH])
        return np.concatenate([python_columns(e, q, v, a, tau, sign, self.time) for e in self.effects], axis=1)

    def _evaluate_in_python(self, q: Array, v: Array, a: Array, tau: Array) -> None:
        width = self.joint[self.k.WIDTH]
        sign = np.tanh(v / width)
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            self._phi[span] = python_columns(self.effects[i], q, v, a, tau, sign, self.time)
        if self.nominal.others.terms:
            self.joint[self.k.OUTSIDE] = self.nominal.outside(q, v, a, tau, self.time, width)
