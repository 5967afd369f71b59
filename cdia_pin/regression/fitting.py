"""Fitting: normal equations around a model, Gauss-Newton to the joint optimum, intervals that know of blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Signal, Term
from cdia_pin.regression.design_matrix import Columns
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.noise import NoiseModel
from cdia_pin.regression.shape_slopes import slopes
from cdia_pin.selection.evidence import Evidence

Array = NDArray[np.float64]

MOST_ITERATIONS = 20
SCATTER = (
    1.36  # variance between blocks over that within, which ten blocks of white noise pass in one case of five
)
CONVERGED = 0.1  # standard deviations by which no parameter moves any more


@dataclass(frozen=True)
class Whitened:
    """What turns residuals into evidence: the noise of each joint, which samples count, and blocks of time.

    Attributes:
        noise: One model per joint.
        used: Samples that count, shape (K, n).
        edges: First sample of each block and the end, shape (B + 1,).
    """

    noise: tuple[NoiseModel, ...]
    used: NDArray[np.bool_]
    edges: NDArray[np.intp]

    @classmethod
    def of(cls, experiment: Experiment, noise: Sequence[NoiseModel], edges: NDArray[np.intp]) -> Whitened:
        """Combine an experiment's informative samples with the noise of its joints."""
        return cls(tuple(noise), experiment.informative, edges)

    @property
    def samples(self) -> int:
        """Innovations that count, of all joints."""
        return sum(int((self.used[:, j] & m.kept).sum()) for j, m in enumerate(self.noise))

    def joint(self, j: int, signal: Array) -> Array:
        """Whiten a signal of joint j, shape as given (K, …).

        Samples that do not count are cleared before, so that what happens near rest does not reach those after it, and
        again after.
        """
        used = self.used[:, j].reshape(-1, *([1] * (signal.ndim - 1)))
        return np.where(used, self.noise[j].whiten(np.where(used, signal, 0.0)), 0.0)


def gather(
    experiment: Experiment,
    columns: Columns,
    prediction: Prediction,
    effects: Sequence[Effect],
    whitened: Whitened,
) -> Evidence:
    """Form the normal equations of candidates around a model.

    The response is what the URDF misses: the model's residual plus what its own terms explain, to first order. The
    terms' effects, with equal shape, are differentiated at their present parameters.

    Args:
        experiment: The conditioned logs.
        columns: Where columns come from.
        prediction: Of the present model.
        effects: All candidates, the model's own among them.
        whitened: Noise and blocks.
    """
    present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
    ends = np.cumsum([e.size for e in effects])
    total = int(ends[-1]) if len(effects) else 0
    per_joint: list[list[tuple[slice, Array]]] = [[] for _ in range(experiment.robot.n)]
    response = prediction.residual.copy()
    for effect, end in zip(effects, ends, strict=True):
        theta = present.get(effect)
        x = columns.of(effect, prediction, theta)
        for i, j in enumerate(effect.acts_on(experiment.robot)):
            per_joint[j].append((slice(int(end) - effect.size, int(end)), x[:, i, :]))
            if theta is not None:
                response[:, j] += x[:, i, :] @ theta
    blocks = np.zeros((len(whitened.edges) - 1, total + 1, total + 1))
    for j, parts in enumerate(per_joint):
        at = np.concatenate([*(np.arange(s.start, s.stop) for s, _ in parts), [total]]).astype(int)
        stacked = whitened.joint(j, np.column_stack([*(x for _, x in parts), response[:, j]]))
        for b, (start, stop) in enumerate(zip(whitened.edges[:-1], whitened.edges[1:], strict=True)):
            rows = stacked[start:stop]
            blocks[b][np.ix_(at, at)] += rows.T @ rows
    return Evidence(experiment.robot, list(effects), blocks, whitened.samples)


def is_exact(effect: Effect) -> bool:
    """Tell whether normal equations know an effect as it is, however large it is."""
    return effect.traits.linear and Signal.TORQUE not in effect.traits.depends_on


def refit(
    experiment: Experiment,
    columns: Columns,
    model: Dynamics,
    whitened: Whitened,
    iterations: int = MOST_ITERATIONS,
) -> tuple[Dynamics, Evidence]:
    """Fit all terms of a model together by Gauss and Newton.

    Args:
        experiment: The conditioned logs.
        columns: Where columns come from.
        model: Its terms' parameters are where the iteration starts.
        whitened: Noise and blocks.
        iterations: Most of them.

    Returns:
        The model at the optimum, and the normal equations there: of its terms, then of the slopes of their shapes.
    """
    effects = [t.effect for t in model.terms]
    exact = all(map(is_exact, effects))
    for _ in range(1 if exact else iterations):
        evidence = gather(experiment, columns, experiment.predict(model), effects, whitened)
        before = np.concatenate([t.theta for t in model.terms]) if model.terms else np.zeros(0)
        fit = evidence.fit(range(len(effects)), bodies=True)
        model = with_parameters(model, fit.theta)
        moved = np.abs(fit.theta - before) * evidence.scale  # in standard deviations of a lone parameter
        if not len(moved) or moved.max() < CONVERGED:
            break
    of_shapes = list(slopes(model))
    if of_shapes or (effects and not exact):
        evidence = gather(experiment, columns, experiment.predict(model), [*effects, *of_shapes], whitened)
    return model, evidence


def with_parameters(model: Dynamics, theta: Array) -> Dynamics:
    """Return a model with all its terms' parameters set, one after another."""
    terms, at = [], 0
    for term in model.terms:
        values = theta[at : at + term.effect.size]
        terms.append(Term(term.effect, tuple(float(v) for v in values), term.profile))
        at += term.effect.size
    return Dynamics(model.robot, tuple(terms))


def with_intervals(model: Dynamics, evidence: Evidence) -> Dynamics:
    """Return a model whose terms carry 95 % intervals.

    They are those of the whitened fit, unless the scores of contiguous blocks scatter more than its noise allows: then
    that scatter counts, with the few degrees of freedom that it has [Liang1986]. A shape that was searched for takes
    its share as a parameter does, through its slope: without it a ripple whose frequency is not known has intervals
    four times too narrow.

    Args:
        model: A model at its optimum.
        evidence: Normal equations there, of its terms and after them of what else was fitted, such as shapes.
    """
    from scipy.special import ndtri, stdtrit

    if not model.terms:
        return model
    theta = np.concatenate([t.theta for t in model.terms])
    gram = evidence.total[:-1, :-1] + np.diag(evidence.prior)
    unit = 1.0 / np.sqrt(np.diag(gram))
    inverse = np.linalg.pinv(gram * np.outer(unit, unit), rcond=1e-12, hermitian=True) * np.outer(unit, unit)
    scores = evidence.blocks[:, :-1, -1] - evidence.blocks[:, :-1, : len(theta)] @ theta
    freedom = len(scores) - 1
    between = np.diag(inverse @ (scores.T @ scores) @ inverse) * len(scores) / freedom
    within = np.diag(inverse)
    half = np.where(
        between > SCATTER * within,
        float(stdtrit(freedom, 0.975)) * np.sqrt(np.maximum(between, 0.0)),
        float(ndtri(0.975)) * np.sqrt(np.maximum(within, 0.0)),
    )
    terms, at = [], 0
    for term in model.terms:
        part = slice(at, at + term.effect.size)
        ci95 = tuple((float(v - h), float(v + h)) for v, h in zip(theta[part], half[part], strict=True))
        terms.append(Term(term.effect, term.theta, term.profile, ci95))
        at += term.effect.size
    return Dynamics(model.robot, tuple(terms))
