"""Rows of the arrays that `sample_kernel` works on; a row has one number for each joint."""

from __future__ import annotations

# Rows of `bounds`.
LOWER = 0  # smallest position [rad or m]
UPPER = 1  # largest position [rad or m]
FASTEST = 2  # largest speed [rad/s or m/s]
STRONGEST = 3  # largest torque [N·m or N]
ACCELERATION = 4  # largest acceleration [rad/s² or m/s²]
VELOCITY_SLACK = 5  # largest step of the velocity beside the acceleration's [rad/s or m/s]
POSITION_SLACK = 6  # largest distance of a position from where the velocity leads [rad or m]
TORQUE_SLACK = 7  # largest step of the torque [N·m or N]
ZERO_VELOCITY = 8  # speed from which a sudden zero is suspicious [rad/s or m/s]
ZERO_TORQUE = 9  # torque from which a sudden zero is suspicious [N·m or N]
TRAVEL_BOUND = 10  # distance by which a signal that stays the same may be wrong [rad or m]
HOLD_VELOCITY = 11  # ticks for which a velocity may stay the same
NOISY_AT_REST = 12  # 1 if a velocity does not stay the same even at rest
HOLD_TORQUE = 13  # ticks for which the torque of a joint in motion may stay the same
REST_SPEED = 14  # speed below which a joint may be at rest [rad/s or m/s]
SATURATED = 15  # torque from which it may stay the same because it is at its limit [N·m or N]
DRIFT_BOUND = 16  # largest sum of the distances within the memory [rad or m]
BOUND_ROWS = 17  # their number [1]

# Rows of `state`.
PREVIOUS_POSITION = 0  # of the sample before, whether it was good or not [rad or m]
PREVIOUS_VELOCITY = 1  # [rad/s or m/s]
PREVIOUS_TORQUE = 2  # [N·m or N]
ACCEPTED_POSITION = 3  # of the last good sample; up to date only while samples are bad [rad or m]
ACCEPTED_VELOCITY = 4  # [rad/s or m/s]
ACCEPTED_TORQUE = 5  # [N·m or N]
HELD_POSITION = 6  # ticks for which the position has been the same
HELD_TRAVEL = 7  # what the velocity says of the distance within them [rad or m]
HELD_VELOCITY = 8  # ticks for which the velocity has been the same
HELD_ERROR = 9  # distance by which it has been wrong within them [rad or m]
HELD_TORQUE = 10  # ticks for which the torque has been the same
DRIFT = 11  # sum of the distances of positions from where the velocity leads, within the memory [rad or m]
ACCUSED = 12  # why a sensor is accused, one of `sample_codes`
TRAVELLED = 13  # distance since the last good sample, by the velocity [rad or m]
VELOCITY_STEP = 14  # of this sample [rad/s or m/s]
ERROR = 15  # distance of this sample's position from where the velocity leads [rad or m]
TORQUE_STEP = 16  # of this sample [N·m or N]
STATE_ROWS = 17  # their number [1]

# Entries of `scalars`.
PREVIOUS = 0  # time of the sample before [s]; −∞ before the first
ACCEPTED = 1  # time of the last good sample [s]
IS_GOOD = 2  # 1 while samples are good
JOINT = 3  # index of the joint that the last code is about
HAS_VELOCITY = 4  # 1 if velocities are measured
PERIOD = 5  # usual time between ticks [s]
SHORTEST = 6  # least time between ticks [s]
LONGEST = 7  # largest time between ticks that may be bridged [s]
MEMORY = 8  # time over which distances are summed [s]
SCALARS = 9  # their number [1]
