"""Arms with hidden effects and a bump that has no name, and a model that a search could have found there."""

from collections.abc import Sequence

import numpy as np

from cdia_pin import Dynamics, Log, RobotModel
from cdia_pin.effects import parse_term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem, WhitenedProblem
from tests.made_logs import motion


def bumped(
    robot: RobotModel,
    hidden: Sequence[str],
    found: Sequence[str],
    given: Sequence[str],
    effects: tuple[str, ...] | None,
    bump: float,
    scale: Sequence[float] = (1.0, 1.0),
) -> tuple[WhitenedProblem, Dynamics, Dynamics]:
    """Return the problem, a found model and the model before it, of an arm whose drives report a share [1] each."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    effort = Dynamics(robot, tuple(map(parse_term, hidden))).inverse_dynamics(q, v, a)
    effort[:, 1] += bump * np.exp(-(((q[:, 1] - np.median(q[:, 1])) / 0.15) ** 2))
    effort = effort * scale + np.random.default_rng(0).normal(0.0, 0.01, effort.shape)
    log = Log(robot.joints, t, q, effort)
    before = Dynamics(robot, tuple(map(parse_term, given)))
    logs = Problem.conditioned(robot, [log], [], DiscoverySettings(effects=effects)).around(before)
    problem = logs.with_first_noise(before)
    model = fitted_together(problem.regression, Dynamics(robot, tuple(map(parse_term, (*given, *found)))))
    return problem, model, before
