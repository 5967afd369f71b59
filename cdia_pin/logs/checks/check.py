"""The check of a log against a robot: every inference, and advice on what to do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from cdia_pin.errors import LogError
from cdia_pin.logs.checks.angle_unit import find_conventions
from cdia_pin.logs.checks.another_arm import check_arm
from cdia_pin.logs.checks.effort_kind import check_effort_kind, gravity_gains
from cdia_pin.logs.checks.excitation import check_excitation
from cdia_pin.logs.checks.finding import Finding, LogCheck, Severity, Topic
from cdia_pin.logs.checks.lag import check_lag
from cdia_pin.logs.checks.limits import check_limits, check_saturation
from cdia_pin.logs.checks.motion import motion_of
from cdia_pin.logs.checks.sampling import check_gaps, check_rate, check_repeats, check_resolution
from cdia_pin.logs.checks.sign_and_order import check_conventions
from cdia_pin.logs.checks.stretches import check_copied, check_held
from cdia_pin.logs.checks.stuck import check_stuck
from cdia_pin.logs.checks.torque_side import check_torque_side
from cdia_pin.logs.checks.unpowered import check_unpowered, unpowered
from cdia_pin.logs.checks.unsigned import check_unsigned, unsigned
from cdia_pin.logs.checks.velocity import check_velocity
from cdia_pin.logs.checks.wild import check_wild
from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.held_stretch import held_stretch
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import require_magnitudes
from cdia_pin.logs.wild_samples import repaired, wild_samples

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel


def check_log(log: Log, robot: RobotModel) -> LogCheck:
    """Infer what a log holds, and whether it can be used for this robot.

    Sampling, resolution, limits, saturation and excitation are checked. Single samples that no motion makes, and a
    stretch in which nothing was measured, are named and left out of the other checks. Efforts are compared with the
    URDF's rigid-body torque and friction of unknown size. This checks units, signs, the order of joints, how the base
    stands, the kind of effort and its lag. An arm on this machine that explains the efforts clearly better is named. A
    finding states where the evidence is weak. It is *not* checked whether the zero of each position is the URDF's, or
    whether drive gains are right.

    Args:
        log: The log, joints in the robot's order.
        robot: The robot of the log.

    Returns:
        The findings; ``ok`` is True if none is a warning or an error.

    Raises:
        LogError: If the joints of the log are not those of the robot, or its numbers are beyond all units.
    """
    if log.joints != robot.joints:
        raise LogError(
            f"{log.source}: the log has joints {', '.join(log.joints)}, robot '{robot.name}' has "
            f"{', '.join(robot.joints)}"
        )
    return LogCheck(log.source, robot.name, tuple(_findings(log, robot)), log.sha256)


def _findings(log: Log, robot: RobotModel) -> Iterator[Finding]:
    yield from (Finding(Topic.READING, Severity.INFO, note) for note in log.notes)
    yield from check_rate(log)
    yield from check_gaps(log)
    wild = wild_samples(log, velocities=True)
    yield from check_wild(log, wild)
    log = repaired(log, wild)
    require_magnitudes(log)
    held = held_stretch(log)
    yield from check_held(log, held)
    log = log if held is None else held.left_out_of(log)
    motion = motion_of(log, robot.is_prismatic)
    yield from check_repeats(log, robot, motion)
    yield from check_stuck(log, robot)
    yield from check_copied(log)
    yield from check_resolution(log, robot, motion)
    yield from check_limits(log, robot)
    sizes = unsigned(log)
    yield from check_unsigned(log, sizes)
    judged = motion and replace(motion, moves=motion.moves & ~sizes)  # nothing more is told of sizes
    yield from check_saturation(log, robot, judged)
    yield from check_velocity(log, motion)
    if motion is None or judged is None:
        yield Finding(
            Topic.EXCITATION,
            Severity.WARNING,
            "too short to compare with the model; units, signs, order and kind of effort were not checked",
            advice="record 10 s or more without a gap",
        )
        return
    if sizes.any() and not judged.moves.any():
        yield from check_excitation(log, robot, motion)
        return
    search, units = find_conventions(log, judged, robot)
    off = unpowered(judged, robot, search)
    if off.any():
        yield from check_unpowered(log, robot, off)
        judged = replace(judged, moves=judged.moves & ~off)
        search, units = find_conventions(log, judged, robot)
    yield from units
    yield from check_conventions(log, robot, search)
    recorded, motion, judged = judged, *(search.conventions.apply(m, robot) for m in (motion, judged))
    robot = search.conventions.mounted(robot)
    yield from check_excitation(log, robot, motion)
    gains = gravity_gains(judged, robot)
    if log.effort_origin is EffortOrigin.MEASURED:
        yield from check_arm(robot, judged, recorded, gains)
    yield from check_effort_kind(log, gains)
    yield from check_torque_side(log, robot, judged)
    yield from check_lag(log, robot, search.conventions)
