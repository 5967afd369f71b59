"""A model that was learned from the healthy runs themselves, tried on motion that it does not know.

Such a model leaves little on its own log, and more on the next one. Its terms are therefore fitted again to one half
of the motion and tried on the other half.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.diagnosis.healthy_part import halves
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.errors import LogError, ModelError
from cdia_pin.logs.log import Log
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import Problem

SHARED_TIME = 0.5  # [1], share of a motion that a run must cover to be its log: the run may be a part of it
LEAST_TRAVEL = 0.01  # [rad or m], range of a joint above which it says whether two motions are the same
SAME_POSITION = 0.02  # [1], distance over that range within which filtered and raw positions agree
SAME_SHARE = 0.9  # [1], share of the samples that must agree; peaks are filtered away


def refitted_halves(
    model: Dynamics, runs: Sequence[Log], least: float
) -> tuple[tuple[Nominal, tuple[Log, ...]], ...]:
    """Return the model fitted to each half of the motion, with the other half.

    Args:
        model: The model.
        runs: Healthy runs.
        least: Length of a piece that counts [s].

    Returns:
        Empty if the model was not learned from these runs, or halves of them do not determine it.
    """
    if not model.terms or not any(is_log_of(motion, run) for motion in model.learned_from for run in runs):
        return ()
    first, second = halves(runs, least)
    try:
        return (_fitted(model, first), second), (_fitted(model, second), first)
    except (LogError, ModelError):  # too short, or a link without mass
        return ()


def is_log_of(motion: Motion, run: Log) -> bool:
    """Tell whether a conditioned motion was made from a run, or from a log of which the run is a part.

    Args:
        motion: The motion.
        run: The run, with the joints of the motion.
    """
    covered = (motion.time >= run.time[0]) & (motion.time <= run.time[-1])
    travel = np.ptp(run.position, axis=0)
    travels = travel > LEAST_TRAVEL
    if covered.mean() < SHARED_TIME or not travels.any():
        return False
    then = motion.time[covered]
    raw = np.column_stack([np.interp(then, run.time, q) for q in run.position.T[travels]])
    near = np.abs(raw - motion.q[covered][:, travels]) <= SAME_POSITION * travel[travels]
    return bool(near.mean() >= SAME_SHARE)


def _fitted(model: Dynamics, runs: Sequence[Log]) -> Nominal:
    problem = Problem.conditioned(model.robot, runs, (), DiscoverySettings())
    fitted, _ = refit(problem.with_noise_of(problem.lack_of_fit(model)).regression, model)
    return Nominal.of(fitted)
