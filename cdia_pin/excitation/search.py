"""The search: motions are drawn and the best is varied. Motions that break a limit or touch anything are rejected."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import RobotError
from cdia_pin.excitation.goals import Goal
from cdia_pin.excitation.information import Information, planned
from cdia_pin.excitation.limits import MotionLimits
from cdia_pin.excitation.motion import Chain, Draw, within_room
from cdia_pin.progress import Progress
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot.collision import CollisionModel, Contact

Array = NDArray[np.float64]

POSTURES = 400  # postures drawn [1] before the search gives up
SHRINKS = 6  # times [1] that a drawn motion is made smaller until it is allowed; six shrink it to a fifth
SMALLER = 0.75  # factor of each shrinking [1]
COARSE = 0.04  # travel between checked postures while searching [rad or m], for speed
# Travel between checked postures in the end [rad or m]; it moves a point at 1 m by the default clearance.
FINE = 0.01
STEPS = (0.5, 0.05)  # size of the first and of the last variation [1], over that of another draw
SAFE = 0.99  # share of the effort limit [1], for what lies between the checked times
HIGHEST_RATE = 1000.0  # rate [Hz] at which the travel is summed


@dataclass(frozen=True, eq=False, repr=False)
class MotionSearch:
    """A search for the motion of the largest score.

    Attributes:
        model: Model of the arm, whose torques must stay within limits.
        limits: Limits of motions.
        collisions: Shapes that must not touch.
        goal: Score of a motion.
        noise: Standard deviation of a torque sample [N·m or N], shape (n,).
        duration: Length of the motion [s].
    """

    model: Dynamics
    limits: MotionLimits
    collisions: CollisionModel
    goal: Goal
    noise: Array
    duration: float

    def __repr__(self) -> str:
        return f"MotionSearch({self.model!r}, {self.duration:g} s)"

    def best(
        self, draws: int, refinements: int, rng: np.random.Generator, tell: Progress
    ) -> tuple[Chain, Chain]:
        """Return the best motion, and the first one that is within the limits, for comparison.

        Args:
            draws: Number of motions that are drawn.
            refinements: Number of variations of the best motion that are tried.
            rng: Source of randomness.
            tell: Called with a sentence and the share done [1].

        Raises:
            RobotError: If the arm cannot rest or move anywhere within the limits.
        """
        first, best, score = None, None, -np.inf
        for k in range(draws):
            tell(f"drawing motions, {k + 1} of {draws}", k / (draws + refinements))
            for draw in self._shrinking(Draw.random(self._posture(rng), rng)):
                value = self._score(draw, above=score)
                if value is not None:
                    first = first or draw
                    best, score = (draw, value) if value > score else (best, score)
                    break
        if best is None or first is None:
            raise RobotError(
                "no motion within the limits was found: allow more time, more speed or less clearance"
            )
        for k in range(refinements):
            tell(f"improving the best, {k + 1} of {refinements}", (draws + k) / (draws + refinements))
            step = STEPS[0] * (STEPS[1] / STEPS[0]) ** (k / max(refinements - 1, 1))
            varied = best.varied(step, self.limits, rng)
            value = self._score(varied, above=score)
            if value is not None and value > score:
                best, score = varied, value
        return self._checked(best), first.trajectory(self.duration, self.limits)

    def contact(self, trajectory: Chain, apart: float) -> Contact | None:
        """Return the first contact on a motion, or None.

        Args:
            trajectory: The motion.
            apart: Travel of a joint between two checked postures [rad or m].
        """
        time = np.arange(0.0, trajectory.duration, 1.0 / HIGHEST_RATE)
        q, v, _ = trajectory(time)
        travelled = np.cumsum(np.abs(v).max(axis=1)) / HIGHEST_RATE
        _, first = np.unique(np.floor(travelled / apart), return_index=True)
        found = self.collisions.first_contact(q[first])
        return Contact(int(first[found.sample]), found.shapes) if found else None

    def _score(self, draw: Draw, above: float) -> float | None:
        """Return a motion's score, None if it is not allowed; contacts are checked only above a given score."""
        trajectory = draw.trajectory(self.duration, self.limits)
        experiment = planned(self.model.robot, trajectory)
        if not self._within_effort(experiment):
            return None
        score = self.goal.score(Information.along(experiment, self.model, self.goal.effects, self.noise))
        if score > above and self.contact(trajectory, COARSE):
            return None
        return score

    def _within_effort(self, experiment: Experiment) -> bool:
        torques = experiment.predict(self.model).torques
        return all((np.abs(t.reading) <= SAFE * self.limits.effort).all() for t in torques)

    def _shrinking(self, draw: Draw) -> Iterator[Draw]:
        for _ in range(SHRINKS):
            yield draw
            draw = draw.smaller(SMALLER)

    def _posture(self, rng: np.random.Generator) -> Array:
        """Draw a posture in which the arm can rest."""
        contact = None
        robot = self.model.robot
        still = np.zeros(robot.n)
        for _ in range(POSTURES):
            q = within_room(rng.uniform(self.limits.lower, self.limits.upper), self.limits)
            if (np.abs(self.model.inverse_dynamics(q, still, still)) > self.limits.effort).any():
                continue
            contact = self.collisions.first_contact(q)
            if contact is None:
                return q
        if contact is None:
            raise RobotError(
                f"robot '{robot.name}': its effort limits do not hold its own weight in any posture that was tried"
            )
        one, two = contact.shapes
        raise RobotError(
            f"robot '{robot.name}': no posture is free of contact, in the last one {one} is too close to {two}; "
            "allow less clearance, no floor, or give the SRDF that says which links may touch"
        )

    def _checked(self, draw: Draw) -> Chain:
        """Return the motion, made smaller until a finer check allows it."""
        for smaller in self._shrinking(draw):
            trajectory = smaller.trajectory(self.duration, self.limits)
            if self._within_effort(planned(self.model.robot, trajectory, cutoff=25.0)) and not self.contact(
                trajectory, FINE
            ):
                return trajectory
        raise RobotError(
            "no motion within the limits was found: allow more time, more speed or less clearance"
        )
