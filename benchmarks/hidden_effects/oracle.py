"""What could be known at best from a log, by one who knows the truth: the noise floor, and which effects can be told.

The oracle has the true columns with the true parameters. What it leaves of a log is the noise, and the noise whitens.
In whitened torques, an effect can be *told* if the best other explanation misses the truth by a squared distance λ
(the noncentrality of a likelihood-ratio test) of 10² at least, ten standard deviations of the noise; it is *confusable*
if another explanation, no less simple, comes closer than 4².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.hidden_effects.truth import label_of
from benchmarks.plant.faults import Fault
from benchmarks.plant.run import Run
from cdia_pin.discovery.comparison import compare
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.effects.body import Body
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.noise import fit_noise
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.whitening import Whitening
from cdia_pin.robot import RobotModel
from cdia_pin.selection.candidates import screen
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.evidence import Evidence
from cdia_pin.selection.problem import Problem

Array = NDArray[np.float64]

TOLD, CONFUSABLE = 10.0**2, 4.0**2


@dataclass(frozen=True)
class Sight:
    """How well one hidden effect shows in a log, beside the others that are hidden.

    Attributes:
        alone: λ of a model that lacks it [1].
        rival: The best other explanation, among the possible ones with no more parameters that the motion tells about.
        apart: λ of that explanation [1]; infinite if there is none.
    """

    alone: float
    rival: str
    apart: float

    @property
    def told(self) -> bool:
        """Whether it can be seen, and told from everything else."""
        return min(self.alone, self.apart) >= TOLD

    @property
    def confusable(self) -> bool:
        """Whether it can be seen, but not told from something else."""
        return self.alone >= TOLD and self.apart < CONFUSABLE


def noise_floor(true: Dynamics, log: Log) -> Array:
    """Return what the true model leaves of a log: noise, quanta and what filtering does [N·m or N], shape (n,)."""
    return compare(true, log).rms


def sights(true: Dynamics, faults: Sequence[Fault], log: Log) -> tuple[Sight, ...]:
    """Return how well each hidden effect shows in a log, to first order around the truth.

    Args:
        true: The model that lacks nothing.
        faults: What is hidden.
        log: The log.
    """
    hidden = [unordered(label_of(f)) for f in faults]
    bare = Dynamics(true.robot, tuple(t for t in true.terms if unordered(t.label) not in hidden))
    problem = Problem.of(bare, [log], [], DiscoverySettings())
    evidence = _evidence(problem, *(problem.experiment.predict(m) for m in (bare, true)))
    place = {unordered(t.label): k for k, t in enumerate(true.terms)}  # the truth comes first
    return tuple(_sight(evidence, [k for k in place.values() if k != place[h]], place[h]) for h in hidden)


def unordered(label: str) -> tuple[str, ...]:
    """Return an effect's name and its joints, whichever of two is written first."""
    name, _, joints = label.partition("@")
    return name, *sorted(joints.split("+"))


def sight_outside(run: Run, robot: RobotModel) -> Sight:
    """Return how well an effect outside the vocabulary shows, and which one effect of it comes closest.

    Args:
        run: The log, and what really happened.
        robot: The arm as its file describes it.
    """
    bare, log = Dynamics(robot), run.log
    exact = replace(log, position=run.truth.position, effort=run.truth.effort)
    problem = Problem.of(bare, [log], [], DiscoverySettings())
    same = Conditioning(cutoff=problem.experiment.segments[0].motion.cutoff)
    missing = Experiment.of(robot, [condition(exact, robot, same)]).predict(bare).residual
    seen = problem.experiment.predict(bare)
    evidence = _around(problem, seen, missing, replace(seen, residual=missing), seen.residual - missing)
    alone = evidence.free_chi2([])
    left = alone - evidence.gains([])
    best = int(np.argmin(left))
    return Sight(alone, evidence.effects[best].label, float(left[best]))


def _evidence(problem: Problem, bare: Prediction, true: Prediction) -> Evidence:
    """Return the normal equations of the true effects, then all others, for a response without noise."""
    around = replace(true, residual=np.zeros_like(true.residual))
    return _around(problem, bare, bare.residual - true.residual, around, true.residual)


def _around(
    problem: Problem, bare: Prediction, missing: Array, around: Prediction, noise_alone: Array
) -> Evidence:
    """Return the normal equations of all effects.

    Args:
        problem: Log and candidates.
        bare: What the file's model predicts.
        missing: What it misses, without noise, shape (K, n).
        around: Where the equations are formed; its residual is the part of the response that its terms do not explain.
        noise_alone: What the noise is known by, shape (K, n).
    """
    experiment, n = problem.experiment, problem.experiment.robot.n
    use = experiment.informative
    noise = [
        fit_noise(noise_alone[:, j], use[:, j], experiment.nearness[:, j], experiment.lengths, 0.0)
        for j in range(n)
    ]
    whitening = Whitening.of(experiment, noise, problem.blocks)
    seen = np.column_stack([whitening.joint(j, missing[:, j]) for j in range(n)])
    screened = screen(problem.families, problem.design, bare, noise, seen)
    effects = dict.fromkeys([*(t.effect for t in around.model.terms), *screened])
    regression = Regression(problem.design, whitening)
    return Evidence(regression.normal_equations(around, list(effects)), problem.settings.criterion)


def _sight(evidence: Evidence, others: list[int], one: int) -> Sight:
    alone = evidence.free_chi2(others)
    hidden = {_physics(evidence.effects[k], evidence.robot) for k in [*others, one]}
    rivals = [
        k
        for k, e in enumerate(evidence.effects)
        if _physics(e, evidence.robot) not in hidden
        and evidence.effective_parameters[k] <= evidence.effective_parameters[one]
    ]
    bound = alone - evidence.gains(others)
    best, apart = "", np.inf
    for k in sorted(rivals, key=lambda k: bound[k]):
        if bound[k] >= apart:
            break
        fit = evidence.fit([*others, k], bodies=True)
        if fit.possible and fit.chi2 < apart:  # friction that pushes is no explanation
            best, apart = evidence.effects[k].label, fit.chi2
    return Sight(alone, best, apart)


def _physics(effect: Effect, robot: RobotModel) -> tuple[str, ...]:
    """Return what an effect is, whatever it is called: a body on the tool is one on the last link."""
    return ("body", str(effect.carrier(robot))) if isinstance(effect, Body) else unordered(effect.label)
