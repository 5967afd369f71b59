"""An experiment: conditioned logs of one robot, the torque that a model predicts for them, and its residual."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ALWAYS, Channel, Effect, SensedFrom, Signal, State
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import Motion
from cdia_pin.logs.motion import names_of
from cdia_pin.logs.torque_side import TorqueSide, side_of_all
from cdia_pin.phrases import clipped, some
from cdia_pin.regression.prediction import Prediction
from cdia_pin.regression.rest import RestSettings
from cdia_pin.regression.segment import Segment
from cdia_pin.robot.model import RobotModel

__all__ = ["Experiment", "Prediction", "Segment", "rms"]

Array = NDArray[np.float64]

# Postures per log [1] at which the mass matrix is computed, because all of them would take long.
POSTURES = 200
SHIFT = 1e-4  # [rad or m], step of an encoder's zero for differences: small beside a ripple, large beside rounding
MOST_PREDICTIONS = 4  # predictions [1] that are kept, of some MB each
NO_LOAD = 1e-9  # variation of a load [N·m or N] that comes from rounding
FEWEST_SAMPLES = 40  # compared samples of a log [1]; fewer do not determine the noise of a joint


@dataclass(frozen=True, repr=False)
class Experiment:
    """Conditioned logs of one robot, ready to be compared with models.

    Attributes:
        robot: The robot.
        segments: One per log.
        measured: Measured torques, compared samples of all segments [N·m or N], shape (K, n).
        moving: True where a joint clearly moves, so that the sample shows friction, shape (K, n).
        nearness: Class of the distance in time from each joint's rest: 0 at rest, largest far away, shape (K, n).
        resting: True for a joint that is near rest, or in its place, for most of every log, shape (n,).
        rest: Settings that decide which samples show friction.
    """

    robot: RobotModel
    segments: tuple[Segment, ...]
    measured: Array
    moving: NDArray[np.bool_]
    nearness: NDArray[np.intp]
    resting: NDArray[np.bool_]
    rest: RestSettings

    def __repr__(self) -> str:
        logs = some([clipped(log, 30) for log in self.logs], 2)
        return f"Experiment({clipped(self.robot.name)}, logs {logs}; {len(self.measured)} compared samples)"

    @classmethod
    def of(cls, robot: RobotModel, motions: Sequence[Motion], rest: RestSettings | None = None) -> Experiment:
        """Prepare conditioned logs for comparison.

        Args:
            robot: The arm.
            motions: Conditioned logs.
            rest: Settings that decide which samples show friction.

        Raises:
            LogError: If a log has other joints than the robot, or nothing is left to compare.
        """
        for motion in motions:
            if motion.joints != robot.joints:
                raise LogError(f"the log's joints {motion.joints} are not the robot's {robot.joints}")
        rest = rest or RestSettings()
        width = np.max([rest.sign_width(m) for m in motions], axis=0)
        segments, moving, nearness = [], [], []
        for motion, name in zip(motions, names_of(motions), strict=True):
            zero = np.zeros_like(motion.q)
            state = State(
                robot,
                motion.q,
                motion.v,
                motion.a,
                zero,
                motion.time,
                width,
                name,
                temperature=motion.temperature,
                sampled_every=1.0 / motion.rate,
            )
            measured = motion.compared(motion.effort)
            if len(measured) < FEWEST_SAMPLES:
                raise LogError(
                    f"{motion.record['source']}: only {len(measured)} independent samples are left after filtering at "
                    f"{motion.cutoff:g} Hz; record for longer"
                )
            segments.append(Segment(motion, state, measured))
            distance = rest.distance(motion, motion.v, width)
            nearness.append(rest.nearness(distance))
            moving.append(rest.is_clear(distance) & rest.travels(motion.q, robot))
        all_moving = np.vstack(moving)
        return cls(
            robot,
            tuple(segments),
            np.vstack([s.measured for s in segments]),
            all_moving,
            np.vstack(nearness),
            np.max([m.mean(axis=0) for m in moving], axis=0) < 1 - rest.resting_share,
            rest,
        )

    def without_rest_of(self, effects: Iterable[Effect]) -> Experiment:
        """Return the experiment without the samples at which friction between two joints may stick.

        Such friction depends on the sum of two speeds. It can hold the sum at rest while both joints move.

        Args:
            effects: Effects of a model. The samples at which a joint itself rests are left out in any case.
        """
        shared = [list(e.acts_on(self.robot)) for e in effects if e.traits.dissipative and len(e.scope) == 2]
        moving, nearness = self.moving.copy(), self.nearness.copy()
        for joints in shared:
            width = np.hypot(*self.segments[0].state.sign_width[joints])
            motions = [s.motion for s in self.segments]
            distance = np.concatenate(
                [self.rest.distance(m, m.v[:, joints].sum(axis=1, keepdims=True), width) for m in motions]
            )
            moving[:, joints] &= self.rest.is_clear(distance)
            nearness[:, joints] = np.minimum(nearness[:, joints], self.rest.nearness(distance))
        return replace(self, moving=moving, nearness=nearness) if shared else self

    @cached_property
    def torque_side(self) -> TorqueSide:
        """Side of the gear on which the torque was measured: as the logs say, else as far as they clearly show it.

        It is unknown where a format says that it is behind the gear, and a log shows too much friction for that.
        """
        if any(s.belies_its_format for s in self.segments):
            return TorqueSide.UNKNOWN
        sides = {s.motion.torque_side for s in self.segments}
        if sides == {TorqueSide.UNKNOWN}:
            sides = {s.measured_side for s in self.segments}
        return side_of_all(sides)

    def remembered(self, motions: Iterable[Motion] | None = None) -> tuple[Motion, ...]:
        """Return the logs as a model remembers them: each with the side of the gear that all of them tell.

        Args:
            motions: The logs, conditioned in another way; as they are here if None.
        """
        given, side = motions or [s.motion for s in self.segments], self.torque_side
        return tuple(replace(m, torque_side=side, side_of_format=False) for m in given)

    def sees(self, effect: Effect) -> bool:
        """Return False for what a sensor on the other side of the gear shows, or shows as a part of something else.

        Args:
            effect: The effect.
        """
        return effect.traits.sensed.meets(SensedFrom.of(self.torque_side is TorqueSide.LINK))

    @property
    def informative(self) -> NDArray[np.bool_]:
        """True for the samples that count: those in motion, and a resting joint's unless it is held, shape (K, n)."""
        return (self.moving | self.resting) & ~self.held

    @cached_property
    def in_place(self) -> NDArray[np.bool_]:
        """True for a joint that stays in one place in all logs while others leave theirs, shape (n,)."""
        return ~self.rest.travels(np.concatenate([s.motion.q for s in self.segments]), self.robot)

    @cached_property
    def one_way(self) -> NDArray[np.bool_]:
        """True for a joint that moves one way in nearly all of the samples in which it moves, shape (n,)."""
        v = np.concatenate([s.motion.sampled(s.motion.v) for s in self.segments])
        forth, back = ((self.moving & (sign * v > 0)).sum(axis=0) for sign in (1, -1))
        return np.asarray(np.minimum(forth, back) < self.rest.one_way_share * (forth + back))

    @cached_property
    def held(self) -> NDArray[np.bool_]:
        """True for a resting joint whose torque does not tell its load: a brake or friction holds it, shape (n,).

        It does not follow its load, or the joint shakes in its place, and friction pulls either way by turns.
        """
        if not self.resting.any():
            return np.zeros(self.robot.n, dtype=bool)
        shakes = self.in_place & ((self.nearness > 0).mean(axis=0) >= 1 - self.rest.resting_share)
        rigid = self.measured + self.predict(Dynamics(self.robot)).residual
        load = np.sqrt(np.maximum(np.var(rigid, axis=0) - self.blur**2, 0.0))
        follows = np.std(self.measured, axis=0) >= self.rest.least_following * load
        return np.asarray(self.resting & (shakes | ~follows & (load > NO_LOAD)))

    @property
    def joints_that_move(self) -> NDArray[np.bool_]:
        """True for a joint that is not near rest for most of every log, shape (n,); for all where none moves."""
        return ~self.resting if not self.resting.all() else np.ones_like(self.resting)

    @property
    def logs(self) -> tuple[str, ...]:
        """Names of the logs or conditions, each once."""
        return tuple(dict.fromkeys(s.state.log for s in self.segments))

    @cached_property
    def resolution(self) -> Array:
        """Torque below which structure may come from noise and quantisation of the sensors [N·m or N], shape (n,).

        Position noise becomes torque through the accelerations. It is white only where a joint moves over many steps
        of its encoder. Torque that changes by less than its own step is recorded with structure too.
        """
        return np.sqrt(self.blur**2 + self._mean([s.motion.effort_step**2 / 12 for s in self.segments]))

    @cached_property
    def blur(self) -> Array:
        """RMS torque that position noise causes through the accelerations [N·m or N], shape (n,)."""
        power = []
        for motion in (s.motion for s in self.segments):
            inertia = self.robot.mass_matrix(motion.q[:: max(1, len(motion.q) // POSTURES)])
            power.append(np.mean(inertia**2 @ motion.acceleration_noise**2, axis=0))
        return np.sqrt(self._mean(power))

    def _mean(self, values: Sequence[Array]) -> Array:
        """Return the mean of one value per log, weighted by the compared samples of the log."""
        return np.average(values, axis=0, weights=[len(s.motion.kept) for s in self.segments])

    @property
    def lengths(self) -> list[int]:
        """Compared samples of each segment."""
        return [len(s.measured) for s in self.segments]

    @property
    def runs(self) -> list[int]:
        """Compared samples of each stretch of all segments, which follow each other at an even pace."""
        return [length for s in self.segments for length in s.motion.lengths]

    def forget(self) -> None:
        """Release the torques and regressors of the rigid bodies, which are computed again if they are needed."""
        for segment in self.segments:
            segment.state.forget()

    def predict(self, model: Dynamics) -> Prediction:
        """Predict the torque readings along all segments.

        Args:
            model: The model.
        """
        known = self._predictions
        if model not in known:
            while len(known) >= MOST_PREDICTIONS:
                known.pop(next(iter(known)))
            known[model] = self._predicted(model)
        return known[model]

    @cached_property
    def _predictions(self) -> dict[Dynamics, Prediction]:
        """The last predictions, because one model is asked for several times."""
        return {}

    def _predicted(self, model: Dynamics) -> Prediction:
        torques = tuple(model.torques(s.state) for s in self.segments)
        rows = [
            s.motion.compared(t.reading - s.motion.effort)
            for s, t in zip(self.segments, torques, strict=True)
        ]
        return Prediction(model, torques, np.vstack(rows))

    def columns(
        self,
        effect: Effect,
        prediction: Prediction,
        theta: Array | None = None,
        *,
        at: NDArray[np.intp] | None = None,
        follows_zeros: bool = False,
    ) -> Array:
        """Return the derivative of the residual by each parameter of an effect, filtered like the torques.

        Args:
            effect: The effect, in the model or not.
            prediction: Prediction of the model that has the effect, or for which it is a candidate.
            theta: Parameters of the effect if the model has it, shape (p,): a nonlinear effect is differentiated there,
                and the effect has the profile of the model's term. Zero and always present if omitted.
            at: Which of the joints that the effect acts on are wanted; all if omitted.
            follows_zeros: Whether the columns of an effect in the model are those at the model's true positions, and
                that of an encoder's zero is of all that it moves; else those of the positions that are read.

        Returns:
            Columns of the joints that the effect acts on [N·m or N per unit], shape (K, len(acts_on), p).
        """
        acts_on = list(effect.acts_on(self.robot))
        joints = acts_on if at is None else [acts_on[i] for i in at]
        exact = follows_zeros and theta is not None
        if exact and effect.traits.channel is Channel.POSITION_READING and effect in prediction.present:
            return self._of_shift(effect, prediction)[:, joints, None]
        every, rows = list(range(self.robot.n)), []
        profile = ALWAYS if theta is None else prediction.profile(effect)
        for segment, torques in zip(self.segments, prediction.torques, strict=True):
            x = segment.state
            if exact and prediction.model.moves(effect):
                x = prediction.model.true_state(x)
            elif Signal.GRAVITY in effect.traits.depends_on and prediction.model.turns_gravity:
                x = prediction.model.under_gravity(x)
            if Signal.TORQUE in profile.depends_on.union(effect.traits.depends_on):
                x = x.with_effort(torques.actuator)
            phi = effect.basis(x) if theta is None or effect.traits.linear else effect.jacobian(x, theta)
            part = phi if joints == every else phi[:, joints, :]
            if profile != ALWAYS:
                part = profile(x)[:, None, None] * part
            gain = torques.gain[:, joints]
            if effect.traits.channel is not Channel.TORQUE_READING and (gain != 1.0).any():
                part = part / gain[:, :, None]
            flat = segment.motion.compared(part.reshape(len(part), -1))
            rows.append(flat.reshape(len(flat), len(joints), -1))
        return rows[0] if len(rows) == 1 else np.vstack(rows)

    def read(self, model: Dynamics, columns: Array, joints: Sequence[int]) -> Array:
        """Return what the logs read of torques of some joints, shape (K, joints, p).

        Args:
            model: The model, whose readings may be late.
            columns: Torques at the compared samples [N·m or N per unit], shape (K, joints, p).
            joints: Indices of the joints.
        """
        every = np.zeros((len(columns), self.robot.n, columns.shape[2]))
        every[:, joints] = columns
        parts = np.split(every, np.cumsum(self.lengths)[:-1])
        late = [model.read(s.compared_state, x) for s, x in zip(self.segments, parts, strict=True)]
        return np.vstack(late)[:, joints]

    def _of_shift(self, effect: Effect, prediction: Prediction) -> Array:
        """Return the derivative of the residual by an encoder's zero, which moves all terms of the model, shape (K, n).

        Args:
            effect: The effect, in the model.
            prediction: Prediction of the model.
        """
        model, term = prediction.model, prediction.present[effect]

        def left(step: float) -> Array:
            moved = term.with_theta((term.theta[0] + step,))
            terms = tuple(moved if t is term else t for t in model.terms)
            return self._predicted(Dynamics(model.robot, terms)).residual

        return (left(-SHIFT) - left(SHIFT)) / (2.0 * SHIFT)

    def torque_of(self, effect: Effect, theta: Array, efforts: Sequence[Array]) -> Array:
        """Return the torque of an effect at the compared samples of all segments, filtered like the torques.

        Args:
            effect: The effect.
            theta: Its parameters, shape (p,).
            efforts: Torque of all drives along each segment, for effects that depend on it [N·m or N], (N, n) each.

        Returns:
            In N·m or N, shape (K, n).
        """
        along = zip(self.segments, efforts, strict=True)
        return np.vstack([s.motion.compared(effect.torque(s.state.with_effort(e), theta)) for s, e in along])

    def compared(self, torque: Callable[[Motion], Array]) -> Array:
        """Return a function of the motion at the compared samples of all segments, filtered like the torques.

        Args:
            torque: Function of a conditioned motion of N samples with values of shape (N, …).

        Returns:
            Shape (K, …), in the unit of the function.
        """
        return np.concatenate([s.motion.compared(torque(s.motion)) for s in self.segments])

    def compared_motion(self) -> tuple[Array, Array, Array, Array]:
        """Return time [s], shape (K,), and q, v, a, shape (K, n), at the compared samples of all segments."""
        parts = [
            [s.motion.sampled(x) for x in (s.motion.time, s.motion.q, s.motion.v, s.motion.a)]
            for s in self.segments
        ]
        time, q, v, a = (np.concatenate(p) for p in zip(*parts, strict=True))
        return time, q, v, a

    def along(self, prediction: Prediction) -> State:
        """Return the states of all segments in one, with the model's torque; shapes are chosen on it.

        Args:
            prediction: Prediction of the model.
        """
        first, *others = (s.state for s in self.segments)
        effort = np.vstack([t.actuator for t in prediction.torques])
        if not others:
            return replace(first, effort=effort)
        every = (first, *others)
        q, v, a, time = (
            np.concatenate([getattr(x, name) for x in every]) for name in ("q", "v", "a", "time")
        )
        warmth = [x.temperature for x in every if x.temperature is not None]
        temperature = np.concatenate(warmth) if len(warmth) == len(every) else None
        return replace(first, q=q, v=v, a=a, effort=effort, time=time, temperature=temperature)


def rms(signal: Array, informative: NDArray[np.bool_]) -> Array:
    """Return the root mean square of each joint's signal over the samples that count.

    Args:
        signal: One column per joint, in any unit, shape (K, n).
        informative: Samples that count, shape (K, n).

    Returns:
        In the unit of the signal, shape (n,).
    """
    count = np.maximum(informative.sum(axis=0), 1)
    return np.asarray(np.sqrt(np.sum(np.where(informative, signal, 0.0) ** 2, axis=0) / count))
