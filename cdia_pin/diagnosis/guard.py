"""A guard for an engine that raises on samples that it cannot compute with: one event instead of an exception.

`SafeEngine` keeps bad samples from both engines. What is left for this guard is a computation that fails all the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.engine_interface import BadSampleError
from cdia_pin.diagnosis.sight import JointSight
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, EventStage, Stage, Status, Verdict
from cdia_pin.diagnosis.thesis.thesis_engine import ThesisEngine
from cdia_pin.effects import Term

Array = NDArray[np.float64]

RECOVERY_TIME = 0.2  # [s] of good samples before torques are corrected again: one good sample proves little


class GuardedEngine(Stateful):
    """The engine of the thesis in a control loop, where a bad sensor must not raise an exception.

    The momentum engine does the same by itself, in its compiled tick.

    Args:
        engine: The engine; it raises `BadSampleError` and keeps its state then.
    """

    STATE = ("engine", "_last", "_bad", "_good_since")

    def __init__(self, engine: ThesisEngine) -> None:
        self.engine = engine
        self._n = engine.robot.n
        self._forget()

    def _forget(self) -> None:
        nothing = np.zeros(self._n)
        self._last = Status(-np.inf, (Stage.HEALTHY,) * self._n, nothing, nothing, self.nothing)
        self._bad = False
        self._good_since: float | None = None

    @property
    def nothing(self) -> Array:
        """Zero, where nothing is corrected."""
        return self.engine.nothing

    @property
    def notes(self) -> tuple[str, ...]:
        """What healthy runs taught, one sentence each."""
        return self.engine.notes

    @property
    def sight(self) -> dict[str, JointSight]:
        """Nothing: the thresholds of the thesis are velocities."""
        return {}

    @property
    def learned(self) -> Array:
        """η₀, bound of the unmodelled torque [N·m or N], shape (n,)."""
        return self.engine.unmodelled

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults now believed in."""
        return self.engine.faults

    @property
    def decisions(self) -> tuple[()]:
        """None: the thesis excludes its hypotheses one by one."""
        return ()

    def reset(self) -> None:
        """Return to the start; what healthy runs taught stays."""
        self.engine.reset()
        self._forget()

    @property
    def needs_even_ticks(self) -> bool:
        """No: its observers take any interval."""
        return False

    def pause(self) -> None:
        """Forget past samples; the next one starts again. Beliefs stay, a detection without a decision does not."""
        self.engine.pause()
        self.engine.drop_detection()
        self._bad, self._good_since = True, None

    def update(self, t: float, q: Array, v: Array | None, tau: Array) -> Status:
        """Take one tick; see `Engine.update`."""
        try:
            status = self.engine.update(t, q, v, tau)
        except BadSampleError as error:
            return self._refused(t, str(error))
        if self._bad:
            self._good_since = t if self._good_since is None else self._good_since
            self._bad = t - self._good_since < RECOVERY_TIME
        if self._bad:
            status = replace(status, torque_correction=np.zeros(self._n))
        self._last = status
        return status

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque to command in place of a nominal one; see `Engine.correct`."""
        return tau if self._bad else self.engine.correct(tau, v_desired)

    def _refused(self, t: float, reason: str) -> Status:
        """Correct nothing until samples have been good for a while; beliefs stay."""
        new: tuple[Event, ...] = ()
        if not self._bad:
            joints = self.engine.robot.joints
            said = f"{reason}; nominal control"
            new = (Event(t, EventStage.ACCOMMODATION, joints, Verdict.NONE, reason=said),)
        self._bad, self._good_since = True, None
        self.engine.pause()
        self._last = replace(self._last, time=t, torque_correction=np.zeros(self._n), events=new)
        return self._last
