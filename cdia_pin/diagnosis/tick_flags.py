"""What a tick may ask attention for, one bit each."""

ALARM = 1  # a remainder is beyond its threshold
ABSENT = 2  # an effect's torque has stayed away where it would show
BAD = 4  # a signal is not finite; the tick did nothing
