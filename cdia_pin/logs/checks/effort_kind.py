"""The kind of effort: joint torque, torque without gravity, motor torque, another unit, or a current."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.fit import physical_columns
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.jackknife import jackknife_error
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Of 184 pairs of gains of one joint in two logs of an unchanged arm (seven arms), 95 % agree within two standard
# errors; 91 % with 6 parts, 82 % with 12, because smaller parts are more alike.
PARTS = 4  # parts of a range that are left out in turn [1]
FAINT = 0.35  # [1], gain of the URDF's torque below which no wrong URDF explains it
# [1], gravity of the URDF over the effort from which it may be that of a motor before its gear. Gears of arms reduce by
# 30 to 300; friction of the motor, and a spring that carries a part of the weight, leave less of it.
LEAST_REDUCTION = 10.0
# Where gravity hardly varies, a large gain and a large offset cancel in what the joint carries, and only the URDF's
# small variations tell them apart. It is 0.06 and 0.15 on two joints whose effort is half of the URDF's gravity and
# varies as if it were two and five times, and 0.37 and more on joints of 12 logs of six arms.
STEADY = 0.2  # [1], standard deviation of gravity over its mean, below which it hardly varies
STRONG = 0.1  # [1], gravity of a joint over the largest one; below it tools and cables outweigh the links


@dataclass(frozen=True)
class EffortKind:
    """The likely kind of efforts whose gravity is a multiple of the URDF's within a range.

    Attributes:
        smallest: Lower end of the gain [1].
        largest: Upper end of the gain [1].
        severity: Severity of the finding.
        message: Message with the fields {said}, {middle} and {inverse}.
        advice: Advice with the field {inverse}.
    """

    smallest: float
    largest: float
    severity: Severity
    message: str
    advice: str


UNSCALED = 1e-5  # [1], share of gravity below which efforts are those of no gear and no unit
_NEAR_ONE = (
    "joint torque: gravity appears with gain {said}; the log cannot separate drive gain, masses and payload"
)
KINDS = (
    EffortKind(
        0.0,
        0.04,
        Severity.WARNING,
        "efforts are {middle:.2g} of the URDF's gravity (gain {said}): motor torque before a gear of about "
        "{inverse}, motor currents in A, or another unit; the log cannot prove it",
        "if it is motor torque, --convert reduction={inverse} with the gear ratios of the data sheet; if they are "
        "currents, --convert torque=A --gains gains.json",
    ),
    EffortKind(
        0.04,
        0.5,
        Severity.WARNING,
        "efforts are {middle:.2g} of the URDF's gravity (gain {said}): motor currents in A, a scaled torque, "
        "or a URDF too heavy; the log cannot prove it",
        "if they are currents, --convert torque=A --gains gains.json; the URDF's masses would make the gains "
        "{inverse} N·m/A",
    ),
    EffortKind(
        0.5,
        0.8,
        Severity.INFO,
        _NEAR_ONE,
        "",
    ),
    EffortKind(0.8, 1.25, Severity.OK, "joint torque: gravity appears with gain {said}", ""),
    EffortKind(
        1.25,
        2.0,
        Severity.INFO,
        _NEAR_ONE,
        "",
    ),
    EffortKind(
        2.0,
        20.0,
        Severity.INFO,
        "gravity appears with gain {said}: a payload or masses that the URDF lacks, or another unit; the log "
        "cannot prove it",
        "check the unit of the efforts; 'cdia discover' separates a payload from wrong masses",
    ),
    EffortKind(
        20.0,
        300.0,
        Severity.WARNING,
        "efforts are {middle:.3g} times the URDF's gravity (gain {said}): another unit, or a URDF that lacks "
        "mass",
        "check the unit of the efforts and the masses of the URDF",
    ),
    EffortKind(
        300.0,
        3000.0,
        Severity.ERROR,
        "efforts are about 1000 times the URDF's gravity (gain {said}): they are in N·mm",
        "--convert torque=Nmm",
    ),
    EffortKind(
        3000.0,
        np.inf,
        Severity.ERROR,
        "efforts are {middle:.3g} times the URDF's gravity (gain {said}): in no usual unit of torque",
        "check the unit of the efforts",
    ),
)
"""Kinds in the order of the gain; their ranges leave no gap."""


OF_CURRENTS = (
    EffortKind(
        0.0,
        0.5,
        Severity.WARNING,
        "currents times drive gains are {middle:.2g} of the URDF's gravity (gain {said}): drive gains too small, or a "
        "URDF too heavy; the log cannot prove it",
        "if the URDF's masses are right, multiply the drive gains by {inverse}; 'cdia calibrate' finds them with a "
        "known weight",
    ),
    EffortKind(
        300.0,
        3000.0,
        Severity.ERROR,
        "currents times drive gains are about 1000 times the URDF's gravity (gain {said}): the currents are in mA",
        "--convert torque=mA",
    ),
)
"""What is said in place of the others where drive gains were applied."""

UNMEASURED = {
    EffortOrigin.COMPENSATED: Finding(
        Topic.EFFORT_KIND,
        Severity.INFO,
        "the efforts were recorded without gravity, and the URDF's was added: masses, centres of mass and payload "
        "cannot be judged by them",
        advice="record torques with gravity, or currents, to judge masses",
    ),
    EffortOrigin.COMMANDED: Finding(
        Topic.EFFORT_KIND,
        Severity.WARNING,
        "the efforts are what a controller asked for, not a measurement: what the arm does otherwise does not show",
        advice="record measured torques, or motor currents with drive gains",
    ),
}
"""What is said of efforts whose gravity tells nothing."""


@dataclass(frozen=True)
class GravityGain:
    """Gravity in the effort of a joint as a multiple of the URDF's.

    Attributes:
        gain: Effort per N·m of the URDF's gravity torque [1]; 1 for joint torque and a correct URDF.
        error: Standard error of the gain [1], from leaving out parts of the log in turn: parts of the time, of the
            range of gravity, or of the range of speed, whichever shows the most. Where gravity hardly varies, it
            reaches to the gain that an effort without an offset has.
        dynamic: The same for M q̈ + V, with rotor inertia [1]. It is far from ``gain`` if gravity was
            compensated, and near it if the unit is another.
        share: Standard deviation of gravity with gain 1 over that of the effort [1].
    """

    gain: float
    error: float
    dynamic: float
    share: float

    @property
    def known(self) -> bool:
        """True if the gain differs from zero and is known to about 20 %."""
        return self.error < 0.2 * abs(self.gain)

    @property
    def absent(self) -> bool:
        """True if gravity should be most of the effort but is missing, while inertia is present."""
        return self._faint and abs(self.dynamic) >= FAINT and abs(self.gain) < 0.3 * abs(self.dynamic)

    @property
    def small(self) -> bool:
        """True if gravity should be most of the effort, but it and inertia both are far below the URDF's."""
        return self._faint and abs(self.dynamic) < FAINT

    @property
    def _faint(self) -> bool:
        return abs(self.gain) + 2 * self.error < FAINT and self.share > 0.5


def gravity_gains(motion: SmoothedMotion, robot: RobotModel) -> dict[int, GravityGain]:
    """Fit the gain of gravity together with dynamics, friction and offset.

    Args:
        motion: Signals under the right conventions.
        robot: The robot of the log.

    Returns:
        The gain of each joint, by its index, under which gravity varies enough.
    """
    columns = physical_columns(motion, robot)
    spread = columns[:, :, 1].std(axis=1)
    out = {}
    for k in range(robot.n):
        if not motion.moves[k] or spread[k] < max(STRONG * spread.max(), 1e-3):
            continue
        x = np.column_stack([columns[k][:, :4], np.ones(len(motion.time))])
        y = motion.effort[:, k]
        dynamic, gain = _gains(x, y)
        out[k] = GravityGain(gain, _error(x, y, motion.time), dynamic, float(spread[k] / max(y.std(), 1e-12)))
    return out


def check_effort_kind(log: Log, gains: Mapping[int, GravityGain]) -> Iterator[Finding]:
    """Compare the gravity in the efforts with the URDF's: its size shows the unit, its absence compensation.

    Args:
        log: The log, for names.
        gains: Gravity in the efforts as a multiple of the URDF's, by index of the joint.

    Yields:
        One finding on the kind of effort.
    """
    if log.effort_origin is not EffortOrigin.MEASURED:
        yield UNMEASURED[log.effort_origin]
        return
    known = {k: g for k, g in gains.items() if g.known and not g.absent}
    value = {
        log.joints[k]: {"gravity_gain": g.gain, "standard_error": g.error, "known": g.known}
        for k, g in gains.items()
    }
    absent = {k: g for k, g in gains.items() if g.absent}
    small = {k: g for k, g in gains.items() if g.small}
    if small and not known and not absent:
        yield _far_below(log, small, value)
    elif not known and not absent:
        yield Finding(
            Topic.EFFORT_KIND,
            Severity.INFO,
            "cannot determine the kind of effort: "
            + (
                f"the gain on the URDF's gravity is not known well enough ({_said(log, gains)})"
                if gains
                else "no joint moves far or often enough under gravity"
            ),
            advice="add a log in which joints move up and down several times, and farther",
            value=value,
        )
    elif absent and len(absent) >= len(known):
        yield Finding(
            Topic.EFFORT_KIND,
            Severity.WARNING,
            f"the efforts contain no gravity (gain on the URDF's: {_said(log, absent)}): they are "
            "gravity-compensated, or not joint torques, or weights or springs balance the arm",
            advice="if a controller took it out, --convert gravity=compensated adds the URDF's gravity; without it "
            "gravity would look like a fault. An arm that is balanced needs a URDF with what balances it",
            value=value,
        )
    else:
        yield _judge(log, known, value)


def _far_below(log: Log, small: Mapping[int, GravityGain], value: Mapping[str, object]) -> Finding:
    """Name what efforts far below the URDF's torques may be: of motors before their gears, or currents."""
    inertia = ", ".join(f"{log.joints[k]} {g.dynamic:.2g}" for k, g in small.items())
    currents = "--convert torque=A --gains gains.json"
    if min(g.share for g in small.values()) < LEAST_REDUCTION:
        return Finding(
            Topic.EFFORT_KIND,
            Severity.WARNING,
            f"the efforts are far below the URDF's torques (gain of its gravity {_said(log, small)}, of its inertia "
            f"{inertia}): motor currents in A, or another unit; the log cannot prove it",
            advice=f"if they are currents, {currents}",
            value=value,
        )
    times = ", ".join(f"{log.joints[k]} {g.share:.0f}" for k, g in small.items())
    return Finding(
        Topic.EFFORT_KIND,
        Severity.WARNING,
        f"the URDF's gravity changes many times as much as the efforts ({times} times), each joint by a gain of its "
        "own: they look like the torques of the motors, before the gears, or like motor currents in A; the log cannot "
        "prove it",
        advice="if it is motor torque, give the gear ratios of the data sheet: --convert "
        f"reduction=<joint>:<ratio>,… --torque-side motor; if they are currents, {currents}",
        value=value,
    )


def _judge(log: Log, known: dict[int, GravityGain], value: Mapping[str, object]) -> Finding:
    """Name the kind of effort by the size of its gravity relative to the URDF's."""
    middle = float(np.median([g.gain for g in known.values()]))
    said = _said(log, known)
    if middle < 0:
        return Finding(
            Topic.EFFORT_KIND,
            Severity.WARNING,
            f"gravity appears with the opposite sign (gain {said})",
            advice="check the sign of the efforts, and that the URDF's base is upright",
            value=value,
        )
    inverse = ",".join(f"{log.joints[k]}:{1 / g.gain:.3g}" for k, g in known.items() if g.gain > 0)
    farthest = max((g.gain for g in known.values()), key=lambda gain: abs(np.log(max(gain, 1e-9))))
    deciding = farthest if 0.5 <= min(middle, farthest) <= max(middle, farthest) < 2.0 else middle
    kinds = KINDS if log.effort_tolerance is None else (*OF_CURRENTS, *KINDS)
    kind = next(kind for kind in kinds if kind.smallest <= deciding < kind.largest)
    return Finding(
        Topic.EFFORT_KIND,
        kind.severity,
        kind.message.format(
            said=said, middle=middle, inverse=f"{1 / middle:.0f}" if middle > UNSCALED else "any ratio"
        ),
        advice=kind.advice.format(inverse=inverse),
        value=value,
    )


def _said(log: Log, gains: Mapping[int, GravityGain]) -> str:
    return ", ".join(f"{log.joints[k]} {g.gain:.3g} ± {2 * g.error:.1g}" for k, g in gains.items())


def _error(x: Array, y: Array, time: Array) -> float:
    """Return the standard error of the gain of gravity, the second column [1].

    Parts of the time all hold the same motion: where the model fails alike in each, they agree on a wrong gain. Parts
    of the range of gravity and of speed do not, because a model that fails does so with the posture or the speed.
    """
    error = max(_left_out(x, y, along) for along in (time, x[:, 1], x[:, 2]))
    gravity = x[:, 1]
    if gravity.std() > STEADY * abs(gravity.mean()):
        return error
    without_offset = _gains(x[:, :-1], y)[1]
    return max(error, abs(_gains(x, y)[1] - without_offset))


def _left_out(x: Array, y: Array, along: Array) -> float:
    """Return the standard error of the gain of gravity from leaving out parts of a range [1]."""
    parts = np.array_split(np.argsort(along, kind="stable"), PARTS)
    gains = np.array([_gains(np.delete(x, p, axis=0), np.delete(y, p))[1] for p in parts])
    return float(jackknife_error(gains))


def _gains(x: Array, y: Array) -> tuple[float, float]:
    """Fit the gains of dynamics and of gravity, the first two columns [1]."""
    dynamic, gravity = np.linalg.lstsq(x, y, rcond=None)[0][:2]
    return float(dynamic), float(gravity)
