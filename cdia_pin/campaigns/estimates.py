"""Shares, rates and medians with their 95 % intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import ArrayLike

LEVEL = 0.95  # [1], of every interval
TAIL = (1 - LEVEL) / 2  # [1], chance beyond either end
RESAMPLES = 1000  # of a bootstrap: the ends of its interval then scatter by some percent of its width
FEWEST = 5  # groups below which a bootstrap says nothing
SEED = 0  # of the resampling


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval.

    Attributes:
        value: The estimate; NaN without data.
        lower: Lower end; NaN where there are too few data for one.
        upper: Upper end.
        count: Number of data.
    """

    value: float
    lower: float
    upper: float
    count: int

    def to_dict(self) -> dict[str, float | int]:
        """Return the estimate for JSON."""
        return {"value": self.value, "lower": self.lower, "upper": self.upper, "count": self.count}


def share(hits: int, count: int) -> Estimate:
    """Return a share with the interval of Clopper and Pearson, which holds the truth at least as often as stated.

    Args:
        hits: Number of runs with the property.
        count: Number of all runs.
    """
    from scipy.stats import beta

    if not count:
        return Estimate(nan, nan, nan, 0)
    lower = float(beta.ppf(TAIL, hits, count - hits + 1)) if hits else 0.0
    upper = float(beta.ppf(1 - TAIL, hits + 1, count - hits)) if hits < count else 1.0
    return Estimate(hits / count, lower, upper, count)


def rate(events: int, hours: float) -> Estimate:
    """Return a rate of events of a Poisson process with its exact interval [1/h].

    Args:
        events: Number of events.
        hours: Time in which they happened [h].
    """
    from scipy.stats import chi2

    if not hours > 0:
        return Estimate(nan, nan, nan, 0)
    lower = float(chi2.ppf(TAIL, 2 * events)) / 2 if events else 0.0
    upper = float(chi2.ppf(1 - TAIL, 2 * events + 2)) / 2
    return Estimate(events / hours, lower / hours, upper / hours, events)


def median(values: ArrayLike, groups: Sequence[object]) -> Estimate:
    """Return a median with its bootstrap interval.

    Runs of one arm share its model error, so whole arms are drawn anew.

    Args:
        values: The data; infinite ones count, NaN are left out.
        groups: To what each belongs.
    """
    data = np.asarray(values, float)
    kept = ~np.isnan(data)
    data, names = data[kept], [g for g, k in zip(groups, kept, strict=True) if k]
    if not len(data):
        return Estimate(nan, nan, nan, 0)
    members: dict[object, list[float]] = {}
    for name, value in zip(names, data.tolist(), strict=True):
        members.setdefault(name, []).append(value)
    value = quantile(data, 0.5)  # a datum, as infinite ones have no mean
    if len(members) < FEWEST:
        return Estimate(value, nan, nan, len(data))
    rng, parts = np.random.default_rng(SEED), [np.array(m) for m in members.values()]
    medians = [
        np.quantile(np.concatenate([parts[k] for k in drawn]), 0.5, method="inverted_cdf")
        for drawn in rng.integers(len(parts), size=(RESAMPLES, len(parts)))
    ]
    lower, upper = np.quantile(medians, (TAIL, 1 - TAIL), method="inverted_cdf")
    return Estimate(value, float(lower), float(upper), len(data))


def quantile(values: ArrayLike, q: float) -> float:
    """Return a quantile that is one of the data; NaN without any.

    Args:
        values: The data; infinite ones count, NaN are left out.
        q: Share of the data below it [1].
    """
    data = np.asarray(values, float)
    data = data[~np.isnan(data)]
    return float(np.quantile(data, q, method="inverted_cdf")) if len(data) else nan
