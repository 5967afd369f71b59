"""Rows of the arrays that `contact_kernel` works on; a row has one number for each joint."""

from __future__ import annotations

# Rows of `state`.
DEVIATION = 0  # remainder less its slow part [N·m or N]
LIMIT = 1  # of the deviation now [N·m or N]
SLOW = 2  # slow part of the remainder [N·m or N]
SLOW_LOAD = 3  # slow part of what gravity and motion take by the model [N·m or N]
CHANGING = 4  # has the joint started or stopped of late? 1 at that moment, then falling [1]
BEGUN = 5  # when its deviation began [s]; ∞ without one
PEAK = 6  # largest deviation of this contact [N·m or N]
STATE_ROWS = 7  # their number [1]

# Rows of `limits`.
REST = 0  # largest deviation of a healthy joint at rest [N·m or N]
MOVING = 1  # the same in motion [N·m or N]
FRICTION = 2  # torque that friction may hold at rest, and lose at a start [N·m or N]

# Entries of `scalars`.
FOLLOWS = 0  # 1 once there is a slow part
PRESENT = 1  # 1 during contact
LASTED = 2  # for how long the opposite has been seen [s]
RECOVERED = 3  # until when joints come back from a contact [s]
ENDED = 4  # when the last contact ended [s]
SCALARS = 5  # their number [1]
