"""Comparison of a model with measured torque: how large the error is, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.discovery.discovery_documents import ComparisonJson, ComparisonRecord, RegionJson
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.log import Log
from cdia_pin.phrases import clipped, shortened
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.shares import LEAST, mean_share
from cdia_pin.version import __version__

Array = NDArray[np.float64]

BINS = 10  # regions of each signal [1]
FEWEST = 12  # samples [1] below which a region is not reported, because its mean is noise
CONSTANT = 1e-9  # range of a signal, in its unit, up to which it is the same everywhere but for rounding
REGIONS = 3  # worst regions that are reported per joint [1]


@dataclass(frozen=True, repr=False)
class ResidualRegion:
    """A region of a signal in which a joint's residual is large.

    Attributes:
        joint: Name of the joint.
        signal: ``position``, ``velocity``, ``acceleration``, ``load`` (model torque) or ``time``.
        lower: Lower end of the region [unit of the signal].
        upper: Upper end of the region [unit of the signal].
        rms: RMS residual in the region [N·m or N].
        bias: Mean residual in the region [N·m or N].
        ratio: RMS residual in the region over that of the joint in all logs [1].
        unit: Unit of the signal.
    """

    joint: str
    signal: str
    lower: float
    upper: float
    rms: float
    bias: float
    ratio: float
    unit: str

    def __repr__(self) -> str:
        where = f"{self.signal} {self.lower:.3g} to {self.upper:.3g} {self.unit}"
        return f"ResidualRegion({clipped(self.joint)}, {where}: RMS {self.rms:.3g}, {self.ratio:.3g} × the joint's)"

    def to_dict(self) -> RegionJson:
        """Return the region for JSON."""
        return {
            "joint": self.joint,
            "signal": self.signal,
            "lower": self.lower,
            "upper": self.upper,
            "rms": self.rms,
            "bias": self.bias,
            "ratio": self.ratio,
            "unit": self.unit,
        }


@dataclass(frozen=True, repr=False)
class ResidualShape:
    """The residual of a joint as a function of one signal: mean and spread in each region.

    Attributes:
        edges: Ends of the regions [unit of the signal], shape (R + 1,).
        mean: Mean residual [N·m or N], NaN where a region has too few samples or the signal is constant, shape (R,).
        spread: Standard deviation of the residual [N·m or N], shape (R,).
        count: Number of samples, shape (R,).
        share: Share of the residual's variance that the means explain [1].
    """

    edges: Array
    mean: Array
    spread: Array
    count: NDArray[np.intp]
    share: float

    def __repr__(self) -> str:
        return f"ResidualShape({len(self.mean)} regions, {100 * self.share:.3g} % of the variance)"


@dataclass(frozen=True, repr=False)
class Comparison:
    """A model against logs, joint by joint; arrays have shape (n,) unless stated.

    Attributes:
        model: The model.
        rms: RMS residual [N·m or N].
        torque_rms: RMS measured torque [N·m or N].
        bias: Mean residual [N·m or N].
        autocorrelation: Autocorrelation of the residual at a lag of one compared sample [1].
        worst_regions: Regions where a joint's residual is largest compared with its RMS, worst first.
        shapes: Residual as a function of each signal, by joint and signal.
        time: Time of the compared samples [s], shape (K,).
        signals: ``position``, ``velocity``, ``acceleration``, ``load`` at these times, shape (K, n).
        measured: Measured torque [N·m or N], shape (K, n).
        predicted: Torque of the model [N·m or N], shape (K, n).
        informative: True for samples that count, shape (K, n).
        record: Logs, hashes and settings.
    """

    model: Dynamics
    rms: Array
    torque_rms: Array
    bias: Array
    autocorrelation: Array
    worst_regions: tuple[ResidualRegion, ...]
    shapes: dict[str, dict[str, ResidualShape]]
    time: Array
    signals: dict[str, Array]
    measured: Array
    predicted: Array
    informative: NDArray[np.bool_]
    record: ComparisonRecord

    def __repr__(self) -> str:
        size = f"{len(self.time)} samples, {len(self.rms)} joints"
        error = f"RMS residual {100 * self.mean_error:.3g} % of the torque"
        return f"Comparison({shortened(self.model.robot.name)}, {size}; {error}, mean over the joints)"

    @property
    def relative_rms(self) -> Array:
        """RMS residual over RMS measured torque [1], NaN for a joint without torque."""
        out = np.full(len(self.rms), np.nan)
        np.divide(self.rms, self.torque_rms, out=out, where=self.torque_rms > LEAST)
        return out

    @property
    def worst(self) -> int:
        """Index of the joint with the largest error over its torque."""
        return int(np.argmax(np.nan_to_num(self.relative_rms, nan=-1.0)))

    @property
    def counted(self) -> NDArray[np.bool_]:
        """True for the joints of which samples count, shape (n,)."""
        return np.asarray(self.informative.any(axis=0))

    @property
    def mean_error(self) -> float:
        """RMS residual over RMS measured torque, mean over the joints with a torque that counts [1]."""
        return mean_share(self.rms, self.torque_rms)

    @property
    def residual(self) -> Array:
        """Predicted minus measured torque [N·m or N], shape (K, n)."""
        return self.predicted - self.measured

    def to_dict(self) -> ComparisonJson:
        """Return the JSON of schema ``cdia-comparison/1``."""
        robot = self.model.robot
        return {
            "schema": schemas.COMPARISON,
            "robot": robot.name,
            "joints": list(robot.joints),
            "rms": robot.by_joint(self.rms),
            "relative_rms": robot.by_joint(self.relative_rms),
            "torque_rms": robot.by_joint(self.torque_rms),
            "bias": robot.by_joint(self.bias),
            "autocorrelation": robot.by_joint(self.autocorrelation),
            "worst_regions": [r.to_dict() for r in self.worst_regions],
            "record": self.record,
        }


def compare(
    model: Dynamics, logs: Log | Sequence[Log], *, conditioning: Conditioning | None = None
) -> Comparison:
    """Compare the torque that a model predicts with measured torque.

    Args:
        model: A robot with its terms.
        logs: One log or several.
        conditioning: How the logs are filtered.

    Returns:
        Errors by joint, and the regions where they are large.

    Raises:
        LogError: If a log is too short or of other joints.
    """
    given = [logs] if isinstance(logs, Log) else list(logs)
    return compare_in(
        Experiment.of(model.robot, [condition(log, model.robot, conditioning) for log in given]), model
    )


def compare_in(experiment: Experiment, model: Dynamics) -> Comparison:
    """Compare a model as `compare` does, with logs that are already conditioned.

    Args:
        experiment: The logs.
        model: A robot with its terms.
    """
    prediction = experiment.predict(model)
    use, residual = experiment.informative, prediction.residual
    time, q, v, a = experiment.compared_motion()
    load = np.concatenate(
        [s.motion.sampled(t.actuator) for s, t in zip(experiment.segments, prediction.torques, strict=True)]
    )
    signals = {"position": q, "velocity": v, "acceleration": a, "load": load}
    errors = rms(residual, use)
    count = np.maximum(use.sum(axis=0), 1)
    shapes: dict[str, dict[str, ResidualShape]] = {}
    regions: list[ResidualRegion] = []
    for j, joint in enumerate(model.robot.joints):
        of_joint = {name: values[:, j] for name, values in signals.items()} | {"time": time}
        shapes[joint] = {name: _shape(x[use[:, j]], residual[use[:, j], j]) for name, x in of_joint.items()}
        units = signal_units(bool(model.robot.is_prismatic[j]))
        found = [
            r for name, s in shapes[joint].items() for r in _regions(joint, name, s, errors[j], units[name])
        ]
        regions += sorted(found, key=lambda r: -r.ratio)[:REGIONS]
    return Comparison(
        model=model,
        rms=errors,
        torque_rms=rms(experiment.measured, use),
        bias=np.where(use, residual, 0.0).sum(axis=0) / count,
        autocorrelation=np.array([_autocorrelation(residual[use[:, j], j]) for j in range(model.robot.n)]),
        worst_regions=tuple(sorted(regions, key=lambda r: -r.ratio)),
        shapes=shapes,
        time=time,
        signals=signals,
        measured=experiment.measured,
        predicted=experiment.measured + residual,
        informative=use,
        record={"version": __version__, "logs": [s.motion.record for s in experiment.segments]},
    )


def signal_units(prismatic: bool) -> dict[str, str]:
    """Return the unit of each signal of a joint.

    Args:
        prismatic: True for a prismatic joint.
    """
    x, effort = ("m", "N") if prismatic else ("rad", "N·m")
    return {"position": x, "velocity": f"{x}/s", "acceleration": f"{x}/s²", "load": effort, "time": "s"}


def _shape(signal: Array, residual: Array) -> ResidualShape:
    low, high = np.percentile(signal, [0.5, 99.5]) if len(signal) else (0.0, 1.0)
    edges = np.linspace(low, max(high, low + CONSTANT), BINS + 1)
    at = np.clip(np.digitize(signal, edges) - 1, 0, BINS - 1)
    count = np.bincount(at, minlength=BINS)
    enough = (count >= FEWEST) & (high - low > CONSTANT)
    safe = np.maximum(count, 1)
    mean = np.bincount(at, residual, BINS) / safe
    spread = np.sqrt(np.maximum(np.bincount(at, residual**2, BINS) / safe - mean**2, 0.0))
    variance = float(np.sum(residual**2)) or 1.0
    return ResidualShape(
        edges,
        np.where(enough, mean, np.nan),
        np.where(enough, spread, np.nan),
        count,
        float(np.sum(np.where(enough, count * mean**2, 0.0))) / variance,
    )


def _regions(joint: str, signal: str, shape: ResidualShape, whole: float, unit: str) -> list[ResidualRegion]:
    out = []
    for k in np.flatnonzero(np.isfinite(shape.mean)):
        here = float(np.hypot(shape.mean[k], shape.spread[k]))
        lower, upper = float(shape.edges[k]), float(shape.edges[k + 1])
        out.append(
            ResidualRegion(
                joint, signal, lower, upper, here, float(shape.mean[k]), here / max(whole, 1e-12), unit
            )
        )
    return out


def _autocorrelation(residual: Array) -> float:
    centred = residual - residual.mean() if len(residual) else residual
    power = float(centred @ centred)
    return float(centred[1:] @ centred[:-1]) / power if power > 0 else 0.0
