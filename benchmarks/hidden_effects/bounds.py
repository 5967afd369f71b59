"""The Cramér-Rao bound: how well any unbiased estimate could do on a log, knowing the true noise and all but θ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from benchmarks.plant.noise import Noise
from benchmarks.plant.run import Run
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, State, Term
from cdia_pin.logs.conditioning import Motion, condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.scaled_gram import ScaledGram

Array = NDArray[np.float64]

RANK_CUTOFF = 1e-12  # eigenvalues of scaled information that count as zero, over the largest

STEP = 1e-4  # [1], relative, to differentiate by a shape


def bound_of_log(true: Dynamics, term: Term, run: Run, noise: Noise) -> Array:
    """Return the smallest standard deviations of a term's parameters from every sample of a log, shape (p,).

    Motion and other terms are known, the torques' noise is the true one, white or AR(1); a shape is not known.

    Args:
        true: The model that lacks nothing.
        term: One of its terms.
        run: The log, and the true motion.
        noise: Of its torques.
    """
    t = run.truth
    x = State.of(true.robot, t.position, t.velocity, t.acceleration, effort=t.effort, time=t.time)
    gain = true.torques(x).gain[:, :, None]
    effect, theta = term.effect, np.array(term.theta)
    columns = [effect.jacobian(x, theta) / gain]
    for name, value in effect.shape_values.items():
        up, down = (effect.with_shape(**{name: value * (1 + s)}) for s in (STEP, -STEP))
        slope = (up.torque(x, theta) - down.torque(x, theta)) / (2 * STEP * value)
        columns.append(slope[:, :, None] / gain)
    all_columns = np.concatenate(columns, axis=2)
    rate = 1.0 / (t.time[1] - t.time[0])
    white = _without_memory(all_columns, noise.keep(rate)) / run.noise_std[None, :, None]
    return _deviations(np.einsum("kjp,kjq->pq", white, white))[: effect.size]


def bound_of_conditioned(true: Dynamics, term: Term, run: Run, noise: Noise) -> Array:
    """Return the same from what the conditioning keeps of the log: low frequencies, and no reversals; shape (p,)."""
    motion = condition(run.log, true.robot)
    experiment = Experiment.of(true.robot, [motion])
    effect: Effect = term.effect
    columns = experiment.columns(effect, experiment.predict(true), np.array(term.theta))
    rate = 1.0 / (run.truth.time[1] - run.truth.time[0])
    covariance = _autocovariance(motion, noise.keep(rate), rate, len(run.truth.time))
    information = np.zeros((effect.size, effect.size))
    for i, j in enumerate(effect.acts_on(true.robot)):
        use = experiment.informative[:, j]
        x = np.where(use[:, None], columns[:, i, :], 0.0)
        if not x.any():
            continue
        # Samples that are left out count as if infinitely noisy.
        matrix = covariance[np.abs(np.subtract.outer(np.arange(len(x)), np.arange(len(x))))][np.ix_(use, use)]
        information += x[use].T @ np.linalg.solve(matrix, x[use]) / run.noise_std[j] ** 2
    return _deviations(information)


def _without_memory(signal: Array, keep: float) -> Array:
    """Whiten AR(1) noise of unit variance, along the first axis."""
    out = signal.copy()
    out[1:] = (signal[1:] - keep * signal[:-1]) / np.sqrt(1 - keep**2)
    return out


def _autocovariance(motion: Motion, keep: float, rate: float, count: int) -> Array:
    """Return the autocovariance of AR(1) noise of unit variance after the conditioning, at its samples, shape (K,)."""
    every = round(rate / motion.rate)
    apart = every * motion.decimation
    middle = count // 2
    kernel = np.zeros((len(motion.kept), apart))
    for d in range(apart):
        impulse = np.zeros(count)
        impulse[middle + d] = 1.0
        kernel[:, apart - 1 - d] = motion.compared(
            zero_phase(impulse, motion.record["motion_cutoff"], rate)[::every]
        )
    memory = np.sqrt(1 - keep**2) * keep ** np.arange(round(40 / (1 - keep)))
    response = fftconvolve(kernel.ravel(), memory)
    whole = fftconvolve(response, response[::-1])[len(response) - 1 :: apart]
    out = np.zeros(len(motion.kept))
    out[: min(len(whole), len(out))] = whole[: len(out)]
    out[0] *= 1 + 1e-9
    return out


def _deviations(information: Array) -> Array:
    return np.sqrt(np.diag(ScaledGram.of(information).pseudo_inverse(RANK_CUTOFF)))
