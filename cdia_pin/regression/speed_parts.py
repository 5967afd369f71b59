"""Parts of the range of speed of each joint, of which each is left out in turn.

Blocks of time of one log hold the same motion. Where the model fails alike in each, they agree on a wrong estimate.
What fails at one speed does not at another: estimates without a quarter of the speeds then differ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment

Mask = NDArray[np.bool_]

# More parts are more alike, and the estimates without them differ less: of the parameters that are established in two
# of eight motions of a UR5, 98 % agree with 3 or 4 parts of speeds and positions, 95 % with 6.
PARTS = 4  # parts of the range of speed [1]


def speed_parts(experiment: Experiment, used: Mask) -> list[Mask]:
    """Return the samples of each quarter of the speeds of each joint, the slowest first.

    Args:
        experiment: The conditioned logs.
        used: True for samples that count, shape (K, n). Each part of a joint holds as many of them.

    Returns:
        True for samples of a part, shape (K, n) each.
    """
    speed = np.abs(experiment.compared_motion()[2])
    parts = [np.zeros_like(used) for _ in range(PARTS)]
    for j, counts in enumerate(used.T):
        samples = np.flatnonzero(counts)
        by_speed = samples[np.argsort(speed[samples, j], kind="stable")]
        for part, own in zip(parts, np.array_split(by_speed, PARTS), strict=True):
            part[own, j] = True
    return parts
