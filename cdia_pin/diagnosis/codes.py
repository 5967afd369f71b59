"""What a tick may ask attention for, one bit each; apart from the kernels, which need numba."""

ALARM = 1  # a remainder is beyond its threshold
ABSENT = 2  # an effect's torque has stayed away
BAD = 4  # a signal is not finite; nothing was done
