"""The momentum observer [DeLuca2005]: the filters of all joints, advanced by one compiled call a tick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import prototype
from cdia_pin.diagnosis.compiled_bank import compile_bank, python_columns
from cdia_pin.diagnosis.layout import layout
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.observer_state import ObserverState
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.tick_flags import BAD
from cdia_pin.effects import JointEffect, Signal, Unknown
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SETTLED = 4.0  # [1], time constants of the filter after which it has forgotten a step to 2 %
LEARNING_MEMORY = (
    5.0  # [1], memory of an unknown fault's neurons over that of a decision: a shape needs more motion
)
REST_WIDTHS = 5.0  # [1], widths of the smoothed sign, below which a joint may rest: there sgn is 1 to 1e-4
REST_SHARE = 0.03  # [1], share of a joint's largest speed below which it may rest
LEAST_SIGN_WIDTH = 1e-3  # [rad/s or m/s], over which sgn is smoothed where velocities have no noise


class MomentumObserver(Stateful):
    """Residuals, thresholds, filtered columns and normal equations of all joints.

    Args:
        nominal: The healthy arm.
        effects: Effects whose columns are filtered, on any joint: those of the bank first.
        settings: Bandwidth, memory, debouncing.
        dt: Usual time between ticks [s].
        unknown: Neurons of each joint; a few around zero if omitted.
        bandwidth: γ of each joint [1/s], shape (n,); that of the settings if omitted.

    Attributes:
        state: The state by name.
        residual: Filtered torque that the model lacks [N·m or N], shape (n,).
        threshold: Bound of a healthy residual [N·m or N], shape (n,).
        remainder: Residual less the torque of the believed faults [N·m or N], shape (n,).
        addition: Torque to add to a nominal one [N·m or N], shape (n,).
        bandwidth: γ [1/s], shape (n,).
        q: Positions of the last tick [rad or m], shape (n,).
        v: Velocities of the last tick [rad/s or m/s], shape (n,).
        believed: Parameters of the believed faults, shape (n, P).
        filtered: Filtered columns y, shape (n, P).
        time: Time of the last tick [s]; −∞ before the first.
        inertial: Whether an effect of acceleration is believed in.
        carried: The rigid bodies with what the arm carries now; the residual is that of these.
    """

    STATE = ("state", "time", "inertial")
    # What the arm carries follows from what is believed of the whole arm; the others are views of the state.
    DERIVED = ("carried", "_rigid_terms", "remainder", "addition", "q", "v", "believed")

    def __init__(
        self,
        nominal: Nominal,
        effects: tuple[JointEffect, ...],
        settings: MonitorSettings,
        dt: float,
        unknown: Sequence[Unknown] | None = None,
        bandwidth: Array | None = None,
    ) -> None:
        from cdia_pin.diagnosis.kernels import NEURON_PERIOD, believes_in, refresh  # need numba

        self.nominal, self.settings, self.dt = nominal, settings, dt
        self.carried = nominal.robot
        n = nominal.robot.n
        own = [prototype(t.effect, nominal.robot) for t in nominal.of_joints]  # type: ignore[arg-type]
        self.effects = effects + tuple(e for e in dict.fromkeys(own) if e not in effects)
        self.ends = np.cumsum([0, *(e.size for e in self.effects)])
        unknown = unknown or [Unknown(joint=joint) for joint in nominal.robot.joints]
        neurons = unknown[0].counts
        self._compiled = compile_bank(self.effects)
        self.state = state = ObserverState(layout(n, self.effects, neurons))
        signals = [e.traits.depends_on for e in self.effects]
        self._smooth = self._columns_of([Signal.ACCELERATION in s for s in signals])
        self._driven = self._columns_of(
            [Signal.TORQUE in s and Signal.ACCELERATION not in s for s in signals]
        )
        self.absent_ticks = max(1.0, settings.gone_after / dt)
        state.place_neurons(unknown)
        state.present = 1.0
        state.bandwidth = settings.bandwidth if bandwidth is None else bandwidth
        state.bound = state.rest_bound = np.inf
        state.lowest_velocity, state.highest_velocity = -np.inf, np.inf
        state.forget = np.exp(-dt / settings.memory)
        state.remember = np.exp(-dt * NEURON_PERIOD / (LEARNING_MEMORY * settings.memory))
        state.debounce = settings.debounce
        state.absent_ticks = self.absent_ticks
        state.gain_floor = settings.gain_floor
        for term, kind in zip(nominal.of_joints, own, strict=True):
            at = self.effects.index(kind)
            j = nominal.robot.joint_index(term.effect.scope[0])
            state.known[j, self.ends[at] : self.ends[at + 1]] += term.theta
        # Views that are read at every tick.
        self.residual, self.threshold, self.remainder = state.residual, state.threshold, state.remainder
        self.addition, self.bandwidth = state.addition, state.bandwidth
        self.q, self.v = state.position, state.velocity
        self.believed, self.filtered = state.believed, state.filtered
        self._array, self._tick, self._rigid_terms = (
            state.array,
            self._compiled.tick,
            nominal.robot.rigid_terms,
        )
        self._refresh, self._believes_in = refresh, believes_in
        self._in_python = bool(self._compiled.in_python or nominal.others.terms)
        self._still = np.zeros(n)
        self.inertial = False
        self.use_sign_width(np.full(n, LEAST_SIGN_WIDTH))
        self.reset()

    def _columns_of(self, chosen: Sequence[bool]) -> NDArray[np.bool_]:
        return np.repeat(chosen, np.diff(self.ends)).astype(bool)

    def reset(self) -> None:
        """Forget the past and keep bounds and beliefs; the next tick starts the filters."""
        self.state.forget_past()
        self.time = -np.inf

    def step(self, t: float, q: Array, v: Array, tau: Array) -> int:
        """Advance by one tick.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            tau: Torque since the last tick [N·m or N], shape (n,).

        Returns:
            What needs attention, see `tick_flags`.
        """
        M, nle = self._rigid_terms(q, v)
        if self.time == -np.inf:
            return self._begin(t, q, v, tau, M, nle)
        if self._in_python:
            self._evaluate_in_python(t, q, v, (v - self.v) / (t - self.time), tau)
        asks: int = self._tick(self._array, q, v, tau, M, nle, t)
        if not asks & BAD:
            self.time = t
        return asks

    def _begin(self, t: float, q: Array, v: Array, tau: Array, M: Array, nle: Array) -> int:
        if not np.isfinite([q, v, tau]).all():
            return BAD
        self.time = self.state.time = t
        self.q[:], self.v[:], self.state.nle, self.state.mass[:] = q, v, nle, M
        if self.effects:
            sign = np.tanh(v / self.state.sign_width)
            still = np.zeros_like(q)
            phi = [python_columns(e, q, v, still, tau, sign, t) for e in self.effects]
            self.state.phi = np.concatenate(phi, axis=1)
        return 0

    def carry(self, robot: RobotModel) -> None:
        """Compute the residual of other rigid bodies from now on.

        Args:
            robot: The arm with what it carries; the healthy arm if it carries nothing.
        """
        self.carried = robot
        self._rigid_terms = robot.rigid_terms

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque with which the arm moves as a healthy one would under ``tau`` [N·m or N], shape (n,).

        Args:
            tau: The nominal torque [N·m or N], shape (n,).
            v_desired: Velocity in whose direction dry friction is compensated [rad/s or m/s], shape (n,); the
                measured one if omitted.
        """
        direction = self.v if v_desired is None else v_desired
        a = self._healthy_acceleration(tau) if self.inertial else self._still
        if self._compiled.in_python:
            self._fill_corrections(direction, a, tau)
        found = np.empty(len(tau))
        self._compiled.corrected(self._array, direction, a, tau, True, found)
        return found

    def _healthy_acceleration(self, tau: Array) -> Array:
        """Return the acceleration of a healthy arm under a torque [rad/s² or m/s²], shape (n,)."""
        return np.asarray(np.linalg.solve(self.state.mass, tau - self.state.nle))

    def correct_from_now(self, on: bool) -> None:
        """Set whether `addition` is computed at every tick.

        Args:
            on: Whether it is; `addition` is zero if not.
        """
        self.state.corrects = float(on)
        if not on:
            self.addition[:] = 0.0

    def believe(self, j: int, theta: Array) -> None:
        """Set the parameters of the believed faults of a joint.

        Args:
            j: The joint's index.
            theta: Parameters of the bank's effects, zero for those not believed in, shape (p,), p ≤ P.
        """
        self.believed[j] = 0.0
        self.believed[j, : len(theta)] = theta
        self.refresh(j)
        columns = self.state.parts["columns"]
        self.inertial = self._believes_in(columns, self._smooth)
        self.state.driven = float(self._believes_in(columns, self._driven))

    def refresh(self, j: int) -> None:
        """Compute the remainder of a joint again, after its beliefs or the weights of its neurons have changed.

        Args:
            j: The joint's index.
        """
        parts = self.state.parts
        self._refresh(parts["joint"], parts["columns"], parts["neurons"], j)

    def use_sign_width(self, width: Array) -> None:
        """Set the speed over which sgn q̇ is smoothed, and with it the speed of rest.

        Args:
            width: The speed [rad/s or m/s], shape (n,).
        """
        state = self.state
        state.sign_width = np.maximum(width, LEAST_SIGN_WIDTH)
        state.soft_sign_width = np.maximum(self.settings.soft_sign, state.sign_width)
        state.rest_speed = REST_WIDTHS * state.sign_width

    def use_velocities(self, seen: Array) -> None:
        """Set what velocities healthy runs have had: thresholds are wider beyond, and slower may be rest.

        Args:
            seen: Smallest and largest velocity of each joint [rad/s or m/s], shape (2, n).
        """
        self.state.lowest_velocity = np.minimum(seen[0], 0.0)
        self.state.highest_velocity = np.maximum(seen[1], 0.0)
        fastest = np.abs(seen).max(axis=0)
        self.state.rest_speed = np.maximum(REST_WIDTHS * self.state.sign_width, REST_SHARE * fastest)

    def restart_decision(self, j: int) -> None:
        """Start the normal equations of a joint again; they wait until the filter has forgotten the fault's onset.

        Args:
            j: The joint's index.
        """
        self.state.gram[j] = 0.0
        self.state.weight[j] = 0.0
        self.state.collecting[j] = -np.ceil(SETTLED / (self.bandwidth[j] * self.dt))

    def end_decision(self, j: int) -> None:
        """Stop the normal equations of a joint.

        Args:
            j: The joint's index.
        """
        self.state.collecting[j] = 0.0

    def start_learning(self, j: int) -> None:
        """Start to learn an unknown fault of a joint.

        Args:
            j: The joint's index.
        """
        self._clear_neurons(j)
        self.state.neuron_gram[j] = 0.0
        self.state.learning[j] = 1.0
        self.state.learns = 1.0

    def stop_learning(self, j: int) -> None:
        """Forget the unknown fault that was learned on a joint.

        Args:
            j: The joint's index.
        """
        self._clear_neurons(j)
        self.state.learning[j] = self.state.learned[j] = 0.0
        self.state.learns = float(self.state.learning.any())

    def _clear_neurons(self, j: int) -> None:
        for of_neurons in (self.state.activation, self.state.activated, self.state.weights):
            of_neurons[j] = 0.0

    # ------------------------------------------------------------- effects that numba cannot compile

    def _evaluate_in_python(self, t: float, q: Array, v: Array, a: Array, tau: Array) -> None:
        width = self.state.sign_width
        sign = np.tanh(v / width)
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            self.state.phi_tick[span] = python_columns(self.effects[i], q, v, a, tau, sign, t)
        if self.nominal.others.terms:
            self.state.outside = self.nominal.outside(q, v, a, tau, t, width)
        self._fill_corrections(v, np.zeros_like(a), tau)

    def _fill_corrections(self, direction: Array, a: Array, tau: Array) -> None:
        for i in self._compiled.in_python:
            span = np.s_[:, self.ends[i] : self.ends[i + 1]]
            sign = np.tanh(direction / self.state.soft_sign_width)
            for phi, effort in ((self.state.phi_unloaded, np.zeros_like(tau)), (self.state.phi_loaded, tau)):
                phi[span] = python_columns(self.effects[i], self.q, self.v, a, effort, sign, self.time)
