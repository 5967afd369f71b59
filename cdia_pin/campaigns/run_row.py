"""What came of a run, as a row of a table."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from cdia_pin.phrases import shortened

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class RunRow:
    """A run; NaN, in files null, for what never happened or does not apply.

    Attributes:
        number: Number of the run in its campaign.
        robot: Name of the robot.
        model_error: Largest relative error of the model's inertias [1].
        noise: Noise of the measured torques over their RMS [1].
        settings: Settings of the engine that differ from the defaults, ``NAME=VALUE, …``.
        repeat: Number of the arm.
        arm_seed: Seed of the arm's model error, motions and noise.
        fault: Names of the hidden effects; empty in a healthy run.
        joint: Joints on which they act; empty for the whole arm.
        terms: The faults with their values.
        share: Size of each fault as a share of its joint's torque [1].
        speed: Largest speed of the motion over the limit of the joint [1].
        onset: When the fault begins [s].
        duration: Length of the run [s].
        healthy_time: Time without a fault, during which every alarm is a false one [s].
        false_alarms: Detections before the fault began.
        elsewhere: Detections of other joints after it began.
        detected: Whether a detection named a faulty joint after it began.
        delay: From the onset to that detection [s].
        named: Labels of the effects that were believed at the end; ``nothing`` without any.
        exact: Whether these are the hidden ones, on their joints, and no others.
        holds: Whether the hidden ones were among the explanations of the last isolation.
        tracking: RMS tracking error of the worst joint over that of the healthy arm, with the monitor [1].
        tracking_alone: The same without a monitor [1].
        diverged: Whether the arm ran away in spite of the monitor.
        peaks: Largest residual over threshold of each second without a fault [1].
        delays: Time from the onset to the first crossing of each of `alarm_scores.FACTORS` times the threshold [s].
        seconds: Wall time of the run [s]; the first run of an arm has the time of its learning.
        error: Why the run could not be made; empty if it could.
    """

    number: int
    robot: str
    model_error: float
    noise: float
    settings: str
    repeat: int
    arm_seed: int
    fault: str
    joint: str
    terms: str
    share: float
    speed: float = nan
    onset: float = nan
    duration: float = nan
    healthy_time: float = 0.0
    false_alarms: int = 0
    elsewhere: int = 0
    detected: bool = False
    delay: float = nan
    named: str = ""
    exact: bool = False
    holds: bool = False
    tracking: float = nan
    tracking_alone: float = nan
    diverged: bool = False
    peaks: tuple[float, ...] = ()
    delays: tuple[float, ...] = ()
    seconds: float = 0.0
    error: str = ""

    def __repr__(self) -> str:
        said = "failed" if self.error else "detected" if self.detected else "not detected"
        return f"RunRow({self.number}, {self.robot}, {shortened(self.fault or 'healthy')}, {said})"


def row_schema() -> pa.Schema:
    """Return the schema of a table of runs."""
    import pyarrow as pa

    kinds = {
        "int": pa.int64(),
        "float": pa.float64(),
        "str": pa.string(),
        "bool": pa.bool_(),
        "tuple[float, ...]": pa.list_(pa.float64()),
    }
    return pa.schema([(f.name, kinds[str(f.type)]) for f in fields(RunRow)])


def row_to_dict(row: RunRow) -> dict[str, Any]:
    """Return a row for a file.

    Args:
        row: The row.
    """
    return {name: _without_nan(value) for name, value in asdict(row).items()}


def row_from_dict(given: dict[str, Any]) -> RunRow:
    """Read back what `row_to_dict` wrote.

    Args:
        given: Values by column.
    """
    floats = {f.name for f in fields(RunRow) if f.type == "float"}
    lists = {f.name for f in fields(RunRow) if str(f.type).startswith("tuple")}
    out = dict(given)
    for name, value in given.items():
        if name in floats and value is None:
            out[name] = nan
        elif name in lists:
            out[name] = tuple(nan if v is None else v for v in value)
    return RunRow(**out)


def _without_nan(value: Any) -> Any:
    if isinstance(value, float) and isnan(value):
        return None
    return [_without_nan(v) for v in value] if isinstance(value, tuple) else value
