"""Whitening: residuals of a log are coloured, and evidence that takes them for white is far too sure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import settings_repr

Array = NDArray[np.float64]

SAMPLES_PER_ORDER = 30  # at least, so that a short log has a simple noise model
TAPER = 0.05  # relative fall of the longest lag's covariance, which keeps the estimate a valid covariance


@dataclass(frozen=True, repr=False)
class NoiseSettings:
    """How the noise of a joint is estimated.

    Attributes:
        highest_order: Largest order of the autoregressive model.
        white_share: Share of white noise that is assumed beside it [1], so that no frequency is trusted without limit.
        borrowed: Weight of the joint's overall noise in a class of distance from rest, in samples.
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
        lengths: Samples of each segment; the filter starts anew in each.
    """

    coefficients: Array
    sigma: Array
    lengths: tuple[int, ...]

    def __repr__(self) -> str:
        return f"NoiseModel(order {len(self.coefficients)}, {len(self.sigma)} samples)"

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Samples that have a full past, shape (K,)."""
        p = len(self.coefficients)
        return np.concatenate([np.arange(length) >= p for length in self.lengths])

    def whiten(self, signal: Array) -> Array:
        """Return the innovations in units of σ; samples without a full past are zero, shape as given (K, …)."""
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
    """Fit autoregressive noise by Yule and Walker, over informative samples only.

    Near a reversal the filter blurs sgn q̇ and all that hangs on it, so the innovations have a size of their own at
    each distance from rest.

    Args:
        residual: What a fitted model left [N·m or N], shape (K,).
        informative: Samples that count, shape (K,).
        nearness: Class of distance to the joint's last or next reversal, shape (K,).
        lengths: Samples of each segment, adding up to K.
        parameters: Effective number of parameters of the fit.
        least: Least standard deviation of an innovation [N·m or N].
        settings: How the noise is estimated.

    Returns:
        The noise, its size corrected for those degrees of freedom.
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
    coefficients = np.linalg.solve(toeplitz + 1e-9 * covariance[0] * np.eye(order), covariance[1:])
    noise = NoiseModel(coefficients, np.ones(len(residual)), tuple(lengths))
    usable = informative & noise.kept
    innovations = noise.whiten(used)
    power = float(np.sum(innovations[usable] ** 2)) / max(int(usable.sum()), 1)
    sigma = np.full(len(residual), power)
    for k in np.unique(nearness):
        here = usable & (nearness == k)
        # a class of few samples borrows from the whole
        own = float(np.sum(innovations[here] ** 2))
        sigma[nearness == k] = (own + settings.borrowed * power) / (here.sum() + settings.borrowed)
    freedom = max(usable.sum() - parameters, 0.2 * usable.sum(), 1.0) / max(usable.sum(), 1)
    return NoiseModel(coefficients, np.maximum(np.sqrt(sigma / freedom), max(least, 1e-12)), tuple(lengths))
