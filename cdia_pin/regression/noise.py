"""Noise of a joint: residuals of a log are coloured, and statistics that assume white noise are far too certain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import settings_repr

Array = NDArray[np.float64]

SAMPLES_PER_ORDER = 30  # samples per coefficient [1] at least, so that a short log has a simple noise model
# Relative fall of the covariance at the longest lag [1], so that the estimate stays a valid covariance.
TAPER = 0.05
LEAST_FREE = 0.2  # share of the samples [1] that counts as degrees of freedom of the noise at least


@dataclass(frozen=True, repr=False)
class NoiseSettings:
    """How the noise of a joint is estimated.

    Attributes:
        highest_order: Largest order of the autoregressive model [1].
        white_share: Share of white noise that is added [1], so that no frequency gets an unlimited weight.
        borrowed: Weight of the joint's overall noise in a class of distance from rest [samples], because a class may
            have few samples.
    """

    highest_order: int = 12
    white_share: float = 0.03
    borrowed: float = 20.0

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class NoiseModel:
    r"""Autoregressive noise of one joint, :math:`e_t = \sum_k a_k e_{t-k} + \sigma w_t`.

    Attributes:
        coefficients: a₁ … a_p [1].
        sigma: Standard deviation of each innovation [N·m or N], shape (K,).
        lengths: Samples of each segment; the filter starts again in each.
    """

    coefficients: Array
    sigma: Array
    lengths: tuple[int, ...]

    def __repr__(self) -> str:
        return f"NoiseModel(order {len(self.coefficients)}, {len(self.sigma)} samples)"

    @property
    def kept(self) -> NDArray[np.bool_]:
        """True for samples whose past is long enough for the filter, shape (K,)."""
        p = len(self.coefficients)
        return np.concatenate([np.arange(length) >= p for length in self.lengths])

    def whiten(self, signal: Array) -> Array:
        """Return the innovations of a signal.

        Args:
            signal: Torque or columns of torque [N·m or N], shape (K, …).

        Returns:
            Innovations in units of σ [1], zero where the past is too short, shape (K, …).
        """
        out = np.array(signal, dtype=float)
        for k, a in enumerate(self.coefficients, start=1):
            out[k:] -= a * signal[:-k]
        out[~self.kept] = 0.0
        return out / self.sigma.reshape(-1, *([1] * (out.ndim - 1)))


def fit_noise(
    residual: Array,
    informative: NDArray[np.bool_],
    nearness: NDArray[np.intp],
    lengths: list[int],
    parameters: float,
    least: float = 0.0,
    settings: NoiseSettings | None = None,
) -> NoiseModel:
    """Fit autoregressive noise by the Yule-Walker equations, over informative samples only.

    Near a reversal the filter blurs sgn q̇ and every effect that depends on it. The innovations therefore have their own
    standard deviation in each class of distance from rest.

    Args:
        residual: Residual of a fitted model [N·m or N], shape (K,).
        informative: Samples that count, shape (K,).
        nearness: Class of the distance from the joint's rest, shape (K,).
        lengths: Samples of each segment; they sum to K.
        parameters: Effective number of parameters of the fit [1].
        least: Least standard deviation of an innovation [N·m or N].
        settings: How the noise is estimated.

    Returns:
        The noise; σ is corrected for the degrees of freedom of the fit.
    """
    used = np.where(informative, residual, 0.0)
    settings = settings or NoiseSettings()
    order = int(np.clip(informative.sum() // SAMPLES_PER_ORDER, 1, settings.highest_order))
    starts = np.cumsum([0, *lengths[:-1]])
    products, counts = np.zeros(order + 1), np.zeros(order + 1)
    for start, length in zip(starts, lengths, strict=True):
        e = used[start : start + length]
        w = informative[start : start + length].astype(float)
        for k in range(min(order + 1, length)):
            products[k] += e[k:] @ e[: length - k]
            counts[k] += w[k:] @ w[: length - k]
    covariance = products / np.maximum(counts, 1.0)
    covariance *= 1.0 - np.arange(order + 1) / (order + 1) * TAPER
    covariance[0] = covariance[0] * (1 + settings.white_share) + 1e-18
    toeplitz = covariance[np.abs(np.subtract.outer(np.arange(order), np.arange(order)))]
    # A valid covariance has no eigenvalue below its white part. That of samples with gaps may have, and its innovations
    # would be far larger than the residual.
    lacking = settings.white_share * covariance[0] - float(np.linalg.eigvalsh(toeplitz)[0])
    toeplitz += max(lacking, 0.0) * np.eye(order)
    coefficients = np.linalg.solve(toeplitz + 1e-9 * covariance[0] * np.eye(order), covariance[1:])
    noise = NoiseModel(coefficients, np.ones(len(residual)), tuple(lengths))
    usable = informative & noise.kept
    innovations = noise.whiten(used)
    power = float(np.sum(innovations[usable] ** 2)) / max(int(usable.sum()), 1)
    sigma = np.full(len(residual), power)
    for k in np.unique(nearness):
        here = usable & (nearness == k)
        # a class of few samples uses the overall noise as well
        own = float(np.sum(innovations[here] ** 2))
        sigma[nearness == k] = (own + settings.borrowed * power) / (here.sum() + settings.borrowed)
    free = max(usable.sum() - parameters, LEAST_FREE * usable.sum(), 1.0) / max(usable.sum(), 1)
    return NoiseModel(coefficients, np.maximum(np.sqrt(sigma / free), max(least, 1e-12)), tuple(lengths))
