"""Whether a log is one of another arm: an arm on this machine explains its efforts better than the one that was named.

The rigid-body torque has no gain: an arm of twice the size has the same shape of torque. The arm that was named is also
fitted with any body on its tool, and with one gain for all joints. Another arm must explain the efforts about as
well without them, so that neither a payload nor another unit is taken for another arm. A gain that no unit in use has
is no excuse, for arms of one maker are alike but for their size. Another arm is plausible only if its masses matter:
efforts far below those of the arm that was named, of a motor before its gear or in another unit, are explained by
friction alone, and so by any small arm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.arm_fit import ArmFit, arm_fit, friction_fit, loaded_fit, scaled_fit
from cdia_pin.logs.checks.effort_kind import GravityGain
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.motion import SmoothedMotion

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

SAMPLES = 300  # [samples], many for the ten parameters of a body
OTHER_MASS = 1.5  # [1], gravity over the URDF's, or its inverse, above which other arms are tried
# [1], unexplained share of the efforts, mean over the joints, above which an arm does not explain them. Measured arms
# leave 0.02 to 0.28 with their own URDF.
UNEXPLAINED = 1 / 3
CLEARLY = 1.5  # [1], fall of the misfit that another arm must bring: a factor of e^1.5 in unexplained shares
# [1], misfit by which it may be behind the arm that was named with ten parameters more, or with one more
BEHIND_BODY, BEHIND_GAIN = 3.0, 1.5
MOST_PERCENT = 10.0  # [1], share up to which it is written in percent
LEAST_UNIT = 50.0  # [1], times by which efforts are too large in any other unit: N·cm has 100, N·mm 1000
# Arms of one maker and size differ by 0.6 to 2.2 on measured logs.
# [1], fall of the misfit that the masses of another arm must bring to friction alone. The right arms of measured logs
# bring 4 to 13, arms of other makers less than 0.8.
BEYOND_FRICTION = 1.5
NEAR = 2.2  # misfit behind the best, within which another arm may be the one [1]


def check_arm(
    robot: RobotModel, motion: SmoothedMotion, recorded: SmoothedMotion, gains: Mapping[int, GravityGain]
) -> Iterator[Finding]:
    """Report an arm with as many joints that explains the efforts clearly better.

    Others are tried where gravity needs other masses, where it tells nothing, or where the arm that was named leaves
    most of the efforts unexplained.

    Args:
        robot: The arm that was named.
        motion: Signals under the conventions that suit this arm best.
        recorded: Signals as they were recorded; for another arm they may be right.
        gains: Gravity in the efforts as a multiple of the URDF's, by index of the joint.

    Yields:
        A warning if there is such an arm.
    """
    known = [g.gain for g in gains.values() if g.known and g.gain > 0]
    likely = bool(known) and 1 / OTHER_MASS <= float(np.median(known)) <= OTHER_MASS
    motion = motion.thin(SAMPLES)
    alone = arm_fit(robot, motion)
    if likely and alone.mean < UNEXPLAINED:
        return
    loaded, scaled = loaded_fit(robot, motion), scaled_fit(robot, motion)
    recorded = recorded.thin(SAMPLES)
    arms = {arm.name: arm for arm in _others(robot)}
    others = [fit for arm in arms.values() if (fit := _plausible_fit(arm, (motion, recorded))) is not None]
    if not others:
        return
    best = min(others, key=lambda fit: fit.misfit)
    behind = min(alone.misfit - CLEARLY, loaded.misfit + BEHIND_BODY)
    if not OTHER_MASS < _gain(scaled) < LEAST_UNIT:
        behind = min(behind, scaled.misfit + BEHIND_GAIN)
    if best.misfit > behind or best.mean > UNEXPLAINED:
        return
    near = [f.name for f in sorted(others, key=lambda fit: fit.misfit) if f.misfit < best.misfit + NEAR]
    yield Finding(
        Topic.ROBOT,
        Severity.WARNING,
        f"{_why(known, likely, robot)}: this looks like a log of {' or '.join(map(repr, near))}; "
        f"'{best.name}' leaves {best.mean:.0%} of the efforts unexplained where '{robot.name}' leaves "
        f"{_share(alone.mean)}",
        advice=f"--robot {best.name} if it is that arm; otherwise check the unit of the efforts and the drive gains",
        value={
            "gravity_gains": known,
            "best": best.name,
            "near": near,
            "same_joints": arms[best.name].joints == robot.joints,
            "unexplained": {fit.name: fit.mean for fit in (alone, *others)},
            "unexplained_with_a_body_on_the_tool": loaded.mean,
            "unexplained_with_a_gain": scaled.mean,
        },
    )


def _plausible_fit(arm: RobotModel, readings: Sequence[SmoothedMotion]) -> ArmFit | None:
    """Return the best fit of an arm; None if its masses explain no more than friction, or not with a gain near 1."""
    fit, motion = min(((arm_fit(arm, m), m) for m in readings), key=lambda pair: pair[0].misfit)
    if fit.misfit > friction_fit(arm, motion).misfit - BEYOND_FRICTION:
        return None
    return fit if 1 / OTHER_MASS < _gain(scaled_fit(arm, motion)) < OTHER_MASS else None


def _share(share: float) -> str:
    """Return a share in percent, or as a factor where percents have too many digits to be read."""
    return f"{share:.0%}" if share <= MOST_PERCENT else f"{share:.3g} times their variance"


def _why(known: Sequence[float], likely: bool, robot: RobotModel) -> str:
    if likely or not known:
        return f"the efforts are not those of '{robot.name}'"
    low, high = min(known), max(known)
    times = f"{low:.2g}" if high < 1.05 * low else f"{low:.2g} to {high:.2g}"
    return f"the efforts need masses {times} times those of '{robot.name}'"


def _gain(scaled: ArmFit) -> float:
    """Return the gain on the rigid-body torque of an arm that was fitted with one [1]; 1 if no joint moves."""
    return 1.0 + float(scaled.shared.sum())


def _others(robot: RobotModel) -> Iterator[RobotModel]:
    """Yield the arms on this machine with as many joints of the same kinds."""
    from cdia_pin.robot.catalogue import robots_here

    for arm in robots_here():
        if arm.name != robot.name and arm.n == robot.n and (arm.is_prismatic == robot.is_prismatic).all():
            yield arm
