"""The one place that decides whether a sample can be, before any engine sees it.

A sample that cannot be is dropped whole. What happens then depends on what comes after it:

- The next sample follows from the last good one: it was a spike, and the gap is bridged.
- Samples follow from each other, but not from the last good one, for `RECOVERY_TIME`: they are the new normal, and
  filters start again. If an encoder has shifted by then, it is named and the shift is subtracted.
- Samples stay bad, or a signal stays the same while the arm moves: the sensor is named as faulty, and nothing is
  passed on.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import sample_codes as codes
from cdia_pin.diagnosis import sample_rows as rows
from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.sample_bounds import LEAST_HOLD, MEMORY_TIME, SampleBounds
from cdia_pin.diagnosis.sample_words import why_bad
from cdia_pin.diagnosis.sensor_fault import SensorFault
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, EventStage, Verdict
from cdia_pin.diagnosis.suspect_sensors import Accusation, SuspectSensors

Array = NDArray[np.float64]

EVERY = slice(None)  # joints
RECOVERY_TIME = 0.1  # [s], for which samples must follow from each other to be the new normal
RECOVERY_TICKS = 3  # the least of it at low rates
QUIET_TIME = 0.2  # [s] of good samples after which the next bad one is an event of its own
SENSOR_TIME = 0.3  # [s] of bad samples after which a sensor is called faulty; a shorter disturbance is none
EVIDENT_TIME = 0.1  # [s], the same where the evidence is of many samples already
YOUNG_TICKS = 10  # good samples from the start on, before which the first ones may be those that were bad
HELD_TICKS = 5  # samples with nothing but a step of the torque that are held back before they are called bad
MANY_TIME = (
    1.0  # [s], for which samples must follow from each other after several signals have jumped at once
)
RETURN_SHARE = 0.1  # [1], of the largest speed: uncertainty of a mean velocity over bad samples
COMMANDS = 8  # ticks whose commands are remembered: drives and sensors are late by some ticks
REVERSAL = (
    2.5  # [1], step of the torque over the size of a correction that turns its sign, as that of friction does
)


class Outcome(IntEnum):
    """What is to be done with a sample."""

    ACCEPTED = 0  # pass it on
    BRIDGED = 1  # pass it on; samples before it were dropped
    RESTARTED = 2  # start the filters again and pass it on
    HELD = 3  # drop it silently: the next sample shows whether the step of its torque was a spike
    BAD = 4  # drop it, and correct nothing


GOOD, STEP_OF_TORQUE, ACCEPTED = codes.GOOD, codes.JUMP + codes.TORQUE, Outcome.ACCEPTED


class SampleCheck(Stateful):
    """Decides whether samples can be, and names sensors whose samples cannot.

    Args:
        joints: Names of the joints.
        bounds: What samples can be.
        has_velocity: Whether velocities are measured.

    Attributes:
        sensors: Sensors that are at fault.
        news: Events of the last sample.
        corrections: Last corrections [N·m or N], shape (n,) each; their steps in the torque are no spikes.
        commands: Last commanded torques [N·m or N], shape (n,) each; nor are theirs.
        missed: Ticks between the last good sample and the one that bridges the gap.
    """

    STATE = (
        "sensors",
        "news",
        "corrections",
        "commands",
        "missed",
        "_state",
        "_scalars",
        "_accepted",
        "_bad",
        "_chain",
        "_steps",
        "_entry",
        "_since",
        "_broken",
        "_is_evident",
        "_has_many_jumps",
        "_recent",
        "_quiet",
    )

    def __init__(self, joints: tuple[str, ...], bounds: SampleBounds, has_velocity: bool) -> None:
        from cdia_pin.diagnosis import sample_kernel  # needs numba

        self.bounds, self._joints = bounds, joints
        self._judge, self._since_good = sample_kernel.judge, sample_kernel.since_good
        self._limits, n = bounds.array, len(joints)
        self._state, self._scalars = np.zeros((rows.STATE_ROWS, n)), np.zeros(rows.SCALARS)
        self._still = np.zeros(n)
        self.sensors = SuspectSensors(joints, bounds.array[rows.DRIFT_BOUND])
        self._has_velocity = has_velocity
        self._recovery_ticks = max(RECOVERY_TICKS, RECOVERY_TIME / bounds.period)
        self._fade = float(np.exp(-1.0 / self._recovery_ticks))
        self._many_ticks = max(RECOVERY_TICKS, MANY_TIME / bounds.period)
        self.reset()
        if not self._judge.signatures:
            first_call("the check of samples", (sample_kernel,), self._tried_once)

    def _tried_once(self) -> None:
        """Judge a sample in the types of a control loop, and forget it."""
        none = np.zeros(len(self._joints))
        self._judge(self._limits, self._state, self._scalars, none, none, none, 0.0)
        self.reset()

    def reset(self) -> None:
        """Return to the start; bounds stay."""
        self._state[:], s = 0.0, self._scalars
        s[:] = 0.0
        s[rows.PREVIOUS] = s[rows.ACCEPTED] = -np.inf
        s[rows.IS_GOOD], s[rows.HAS_VELOCITY] = 1.0, float(self._has_velocity)
        s[rows.PERIOD], s[rows.MEMORY] = self.bounds.period, MEMORY_TIME
        s[rows.SHORTEST], s[rows.LONGEST] = self.bounds.shortest, self.bounds.longest
        self.sensors.reset()
        self.news: tuple[Event, ...] = ()
        self.corrections: deque[Array] = deque(maxlen=COMMANDS)
        self.commands: deque[Array] = deque(maxlen=COMMANDS)
        self.missed = 0
        self._accepted, self._bad, self._chain, self._steps = 0, 0, 0, 0
        self._entry, self._since, self._broken, self._is_evident = GOOD, 0.0, False, False
        self._has_many_jumps = False
        self._recent = 0.0  # bad samples within about the recovery time
        self._quiet = np.inf  # ticks since the last bad sample

    def __call__(self, t: float, q: Array, v: Array | None, tau: Array) -> Outcome:
        """Return what is to be done with a sample.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); None where they are not measured.
            tau: Torques [N·m or N], shape (n,).
        """
        self.news = ()
        if v is None or not self._has_velocity:
            v = self._still
        code = self._judge(self._limits, self._state, self._scalars, q, v, tau, t)
        self._accepted += 1
        if code == GOOD and not self._bad:  # so for most samples, which this is made quick for
            self._quiet += 1
            return ACCEPTED
        if code == STEP_OF_TORQUE and self._is_commanded():
            code = GOOD
        if self._bad:
            return self._go_on(code, t, q, v, tau)
        if code == GOOD:
            self._scalars[rows.IS_GOOD] = 1.0
            self._quiet += 1
            return ACCEPTED
        return self._enter(code, t, q, v, tau)

    @property
    def offset(self) -> Array | None:
        """Shift of each encoder, to be subtracted from its readings [rad or m], shape (n,); None without any."""
        return self.sensors.offset

    @property
    def faults(self) -> tuple[SensorFault, ...]:
        """Faults of sensors now known."""
        return self.sensors.faults

    @property
    def last_time(self) -> float:
        """Time of the last good sample [s]; 0 before the first."""
        s = self._scalars
        t = float(s[rows.PREVIOUS] if s[rows.IS_GOOD] else s[rows.ACCEPTED])
        return t if np.isfinite(t) else 0.0

    # ------------------------------------------------------------- bad samples

    def _enter(self, code: int, t: float, q: Array, v: Array, tau: Array) -> Outcome:
        """Take the first bad sample."""
        self._bad, self._chain, self._steps = 1, 0, 0
        self._recent = 1.0 + self._recent * self._fade**self._quiet
        self._entry, self._since, self._is_evident = code, self._time(t), False
        self._broken = codes.kind_of(code) not in (codes.JUMP, codes.ZEROED)
        self._count_jumps()
        if code == STEP_OF_TORQUE:
            return Outcome.HELD
        self._announce(code, t, q, v, tau)
        self._accuse(code, t, q, v, tau)
        return Outcome.BAD

    def _go_on(self, code: int, t: float, q: Array, v: Array, tau: Array) -> Outcome:
        """Take a sample after a bad one."""
        self._bad += 1
        kind = codes.kind_of(code)
        self._chain = self._chain + 1 if code == GOOD else 0
        if kind in (codes.TIME_IMPOSSIBLE, codes.TIME_TWICE, codes.TIME_BACK, codes.GAP, codes.OUTSIDE):
            self._broken = True
        if kind not in (codes.TIME_IMPOSSIBLE, codes.TIME_TWICE, codes.OUTSIDE) and not codes.is_evidence(
            code
        ):
            if self._follows(code, t, q, v, tau):
                self.missed = round((t - self._scalars[rows.ACCEPTED]) / self.bounds.period) - 1
                return self._accept(Outcome.BRIDGED, t)
            if self._chain >= self._recovery_ticks:
                stopped = self._stopped()
                if stopped:
                    code = codes.FROZEN + codes.POSITION
                    self._state[rows.ACCUSED, stopped] = code
                elif self._is_new_normal(t, q, v):
                    return self._accept(Outcome.RESTARTED, t)
        self._recent = self._recent * self._fade + (code != GOOD)
        if self._steps == self._bad - 1 < HELD_TICKS:
            return Outcome.HELD
        self._announce(code, t, q, v, tau)
        self._accuse(code, t, q, v, tau)
        return Outcome.BAD

    def _follows(self, code: int, t: float, q: Array, v: Array, tau: Array) -> bool:
        """Whether a sample follows from the last good one.

        What was bad for some samples must be good for as many: noise comes near the last good sample by chance.
        """
        if self._is_evident or self._repeats(tau, LEAST_HOLD):
            return False
        since = self._since_good(self._limits, self._state, self._scalars, q, v, tau, t)
        asked = min(self._recent, self._recovery_ticks)
        if since == GOOD:
            return 1 + self._chain >= asked
        if since != STEP_OF_TORQUE:
            return False
        if code == GOOD:  # the torque alone has changed, and stays so: it was no spike
            stepped = int(self._scalars[rows.JOINT])
            return self._chain >= asked and not self._repeats(tau, self._recovery_ticks, stepped)
        self._steps += 1
        return False

    def _repeats(self, tau: Array, most: float, joints: int | slice = EVERY) -> bool:
        """Whether a torque repeats itself that may not do so for more than some ticks.

        It confirms nothing: either it changes, or there is soon evidence that its sensor is frozen or dead.

        Args:
            tau: Torques [N·m or N], shape (n,).
            most: Ticks for which a torque may stay the same, at most; others may be held between updates.
            joints: Which joints are asked.
        """
        held, longest = self._state[rows.HELD_TORQUE], self._limits[rows.HOLD_TORQUE]
        is_free = np.abs(tau) < self._limits[rows.SATURATED]
        return bool(((held >= 1) & (held <= longest) & (longest <= most) & is_free)[joints].any())

    def _accept(self, outcome: Outcome, t: float) -> Outcome:
        """Return to good samples."""
        s = self._scalars
        s[rows.IS_GOOD], self._bad = 1.0, 0
        self._quiet = 0
        if good := self.sensors.trust(self._since):
            self._tell(
                t, EventStage.SENSOR, self._joints, f"{', '.join(good)}: readings can be trusted again"
            )
        return outcome

    def _is_commanded(self) -> bool:
        """Whether a step of the torque may be that of a correction, or of a command."""
        allowed = self._limits[rows.TORQUE_SLACK].copy()
        if self.corrections:
            allowed += REVERSAL * np.abs(np.array(self.corrections)).max(axis=0)
        if self.commands:
            allowed += np.ptp(np.array(self.commands), axis=0)
        return bool((np.abs(self._state[rows.TORQUE_STEP]) <= allowed).all())

    def _stopped(self) -> list[int]:
        """Return the joints whose position stopped within a tick; velocities would show it, where they are measured."""
        if self._has_velocity or self._entry != codes.JUMP + codes.POSITION:
            return []
        return np.flatnonzero(self._state[rows.HELD_POSITION] >= self._chain).tolist()

    # ------------------------------------------------------------- sensors

    def _is_new_normal(self, t: float, q: Array, v: Array) -> bool:
        """Whether samples that follow from each other can be trusted; shifts of encoders are then subtracted."""
        young = self._accepted - self._bad < YOUNG_TICKS
        if young or self._broken or self._is_evident or codes.kind_of(self._entry) != codes.JUMP:
            return True
        state, bound = self._state, self._limits[rows.DRIFT_BOUND]
        moved = q - state[rows.ACCEPTED_POSITION]
        shift = moved - state[rows.TRAVELLED]
        found = np.abs(shift) > bound
        if not found.any():
            return True
        if self._entry == codes.JUMP + codes.POSITION and not self._has_many_jumps:
            self._subtract(t, np.where(found, shift, 0.0))
            return True
        # Several signals have jumped, so that the velocities in between say nothing: is all as it was before?
        span = t - self._scalars[rows.ACCEPTED]
        if self._has_velocity:
            moved = moved - 0.5 * (v + state[rows.ACCEPTED_VELOCITY]) * span
        if (np.abs(moved) <= RETURN_SHARE * self.bounds.speed * span + bound).all():
            return True
        if self._chain < self._many_ticks:
            return False
        self._subtract(t, np.where(found, shift, 0.0))
        return True

    def _count_jumps(self) -> None:
        """Note whether more than the position of one joint has jumped."""
        step, error = np.abs(self._state[rows.VELOCITY_STEP]), np.abs(self._state[rows.ERROR])
        b, period = self._limits, self.bounds.period
        jumped = error > b[rows.POSITION_SLACK] + b[rows.ACCELERATION] * period**2
        turned = step > b[rows.VELOCITY_SLACK] + b[rows.ACCELERATION] * period
        if self._has_velocity:
            self._has_many_jumps = bool(jumped.sum() > 1 or turned.any())
        else:
            self._has_many_jumps = bool(turned.sum() > 1)

    def _subtract(self, t: float, shift: Array) -> None:
        """Name encoders that are off since samples were good last."""
        for joint, said in self.sensors.shift(shift, self._since):
            self._tell(t, EventStage.SENSOR, (joint,), said)

    def _accuse(self, code: int, t: float, q: Array, v: Array, tau: Array) -> None:
        """Call sensors faulty once there is enough evidence."""
        evident = codes.is_evidence(code)
        self._is_evident |= evident
        if self._bad * self.bounds.period < (EVIDENT_TIME if evident else SENSOR_TIME):
            return
        kind, signal = codes.kind_of(code), codes.signal_of(code)
        if kind in (codes.TIME_IMPOSSIBLE, codes.TIME_TWICE, codes.TIME_BACK):
            accused: list[Accusation] = [(None, codes.NO_SIGNAL, codes.OUTSIDE)]
        elif evident:
            flags = self._state[rows.ACCUSED].astype(int)
            accused = [(self._joints[j], codes.signal_of(flags[j]), flags[j]) for j in np.flatnonzero(flags)]
        elif kind == codes.OUTSIDE:
            accused = [(self._joints[j], s, code) for s, j in self._outside(q, v, tau)]
        elif kind == codes.JUMP:
            accused = [(self._joints[int(self._scalars[rows.JOINT])], signal, code)]
        elif kind == codes.ZEROED:
            accused = [(joint, signal, code) for joint in self._joints]
        else:
            return
        new = self.sensors.accuse(accused, self._since, is_first_only=kind != codes.OUTSIDE)
        if new:
            joints = tuple(dict.fromkeys(f.joint for f in new if f.joint)) or self._joints
            self._tell(t, EventStage.SENSOR, joints, "; ".join(map(str, new)))

    def _outside(self, q: Array, v: Array, tau: Array) -> list[tuple[int, int]]:
        """Return signal and joint of each value that is not finite or beyond its bounds."""
        b = self._limits
        good = (
            (b[rows.LOWER] <= q) & (q <= b[rows.UPPER]),
            np.abs(v) <= b[rows.FASTEST],
            np.abs(tau) <= b[rows.STRONGEST],
        )
        return [(s, int(j)) for s, one in enumerate(good) for j in np.flatnonzero(~one)]

    # ------------------------------------------------------------- events

    def _time(self, t: float) -> float:
        return t if abs(t) < codes.LATEST else self.last_time

    def _announce(self, code: int, t: float, q: Array, v: Array, tau: Array) -> None:
        """Tell of the first bad sample; those that follow before data have been good for a while are the same event."""
        if self._quiet * self.bounds.period < QUIET_TIME:
            self._quiet = 0
            return
        self._quiet = 0
        j = int(self._scalars[rows.JOINT])
        value = (q, v, tau, q)[codes.signal_of(code)][j]
        said = why_bad(code or self._entry, self._joints[j], float(value), self.last_time, t)
        self._tell(t, EventStage.ACCOMMODATION, self._joints, f"{said}; nominal control")

    def _tell(self, t: float, stage: EventStage, joints: tuple[str, ...], reason: str) -> None:
        self.news += (Event(self._time(t), stage, joints, Verdict.NONE, reason=reason),)
