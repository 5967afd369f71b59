"""Rest: the samples at which a joint moves clearly enough to show its friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.actuation import TURN
from cdia_pin.logs.conditioning import Motion
from cdia_pin.phrases import settings_repr
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

METRE = 1.0  # [m], the most that counts of the range of a joint that slides; of one that turns it is a turn
CLASSES = (1.0, 2.0, 4.0, 8.0)  # limits of the classes of distance from rest, over the least distance [1]


@dataclass(frozen=True, repr=False)
class RestSettings:
    """Which samples show friction.

    Attributes:
        width_over_noise: Width over which sgn(q̇) is smoothed, over the standard deviation of the speed's noise [1]. At
            three, noise hardly ever changes the sign.
        width_over_speed: Least width over the 95th percentile of the speeds driven [1].
        near_rest: Speed below which a joint counts as near rest, over the width [1]. There friction is whatever keeps
            the joint where it is.
        least_distance: Time from rest or a reversal at which a sample counts, in periods of the cut-off [1]. The filter
            mixes what is nearer with the joint at rest, which may stick.
        resting_share: A joint near rest for longer than this share of each log is taken as resting [1].
        one_way_share: A joint that moves one of its ways for less than this share of its motion [1] shows no
            difference between its directions.
        least_following: Variation of a resting joint's torque over that of the rigid bodies' [1], below which a brake
            or static friction holds the joint, and its torque says nothing of its load. A motor that holds a joint
            follows the load, even one that has lost half of its gain.
        least_travel: Travel of a joint in a log over its range, of which no more than a turn or a metre counts [1]. A
            joint that travels less shakes in its place: backlash and the gear's elasticity move it, and what its torque
            does there says nothing of another place. In 50 logs of 15 arms joints travel 1 % or more, or 0.3 % or less.
    """

    width_over_noise: float = 3.0
    width_over_speed: float = 0.005
    near_rest: float = 2.0
    least_distance: float = 0.5
    resting_share: float = 0.95
    one_way_share: float = 0.05
    least_following: float = 0.3
    least_travel: float = 0.005

    __repr__ = settings_repr

    def sign_width(self, motion: Motion) -> Array:
        """Return the width over which sgn(q̇) is smoothed.

        Args:
            motion: The conditioned log.

        Returns:
            Speeds [rad/s or m/s], shape (n,).
        """
        return np.maximum(
            self.width_over_noise * motion.speed_noise,
            self.width_over_speed * np.percentile(np.abs(motion.v), 95, axis=0) + 1e-6,
        )

    def travels(self, q: Array, robot: RobotModel) -> NDArray[np.bool_]:
        """Tell which joints leave their place.

        Args:
            q: Positions in one log or several [rad or m], shape (N, n).
            robot: The arm, n joints.

        Returns:
            Shape (n,); true for all joints of an arm that moves about one posture.
        """
        limits = robot.limits
        whole = np.minimum(limits.upper - limits.lower, np.where(robot.is_prismatic, METRE, TURN))
        leaves = np.asarray(np.ptp(q, axis=0) >= self.least_travel * whole)
        return leaves if leaves.any() else np.ones_like(leaves)

    def is_clear(self, distance: Array) -> NDArray[np.bool_]:
        """Return True for samples that are far enough from rest.

        Args:
            distance: Time from rest, in periods of the cut-off [1], any shape.

        Returns:
            Shape as given.
        """
        return distance > self.least_distance

    def nearness(self, distance: Array) -> NDArray[np.intp]:
        """Return classes of distance, 0 at rest and largest far away.

        Args:
            distance: Time from rest, in periods of the cut-off [1], any shape.

        Returns:
            Shape as given.
        """
        return np.digitize(distance, [self.least_distance * c for c in CLASSES])

    def distance(self, motion: Motion, v: Array, width: Array | float) -> Array:
        """Return the time from each compared sample to the nearest rest or reversal, before or after.

        Args:
            motion: The conditioned log.
            v: Speeds [rad/s or m/s], shape (N, m).
            width: Width over which their sgn is smoothed [rad/s or m/s], scalar or shape (m,).

        Returns:
            Time in periods of the cut-off [1], shape (K, m).
        """
        near_rest = np.abs(v) < self.near_rest * width
        time, out = motion.sampled(motion.time), np.full((len(motion.kept), v.shape[1]), np.inf)
        for j in range(v.shape[1]):
            turns = np.append(v[1:, j] * v[:-1, j] < 0, False)
            at = motion.time[near_rest[:, j] | turns]
            if len(at):
                k = np.searchsorted(at, time)
                before = time - at[np.maximum(k - 1, 0)]
                after = at[np.minimum(k, len(at) - 1)] - time
                out[:, j] = np.minimum(np.abs(before), np.abs(after))
        return out * motion.cutoff
