"""Names of the rows of the observer's state: the one place that numbers them.

The compiled kernels index by these names. All other code reads and writes `ObserverState`, whose attributes are made
from them. Numba keeps its compiled kernels by the date of `kernels.py` alone: after a change of a number here,
touch that file.
"""

# Rows of the part `joint`, each of shape (n,).
RESIDUAL = 0  # r, filtered torque that the model lacks [N·m or N]
THRESHOLD = 1  # bound of the residual of a healthy arm [N·m or N]
REMAINDER = 2  # r − ĉᵀy, residual less the torque of the believed faults [N·m or N]
EXCEEDED = 3  # ticks in a row in which the remainder is beyond the threshold [1]
BOUND = 4  # η₀ while the joint moves, bound of the unmodelled torque [N·m or N]
REST_BOUND = 5  # η₀ near rest and reversals [N·m or N]
SIGN_WIDTH = 6  # speed over which sgn q̇ is smoothed [rad/s or m/s]
VELOCITY = 7  # q̇ of the last tick [rad/s or m/s]
NLE = 8  # Coriolis, centrifugal and gravity torque of the last tick [N·m or N]
COLLECTING = 9  # are normal equations collected (1), not (0), or in how many ticks (< 0)?
WEIGHT = 10  # samples in the normal equations, old ones discounted [1]
OUTSIDE = 11  # torque of the model's terms that are not of one joint, over the interval [N·m or N]
LEARNING = 12  # does the joint learn an unknown fault (1) or not (0)?
LEARNED = 13  # learned torque of the unknown fault, filtered [N·m or N]
AMPLITUDE = 14  # largest torque of the believed faults of late [N·m or N]
MOVING = 15  # share of the filter's memory in which the joint moved [1]; at rest dry friction can be anything
MUTED = 16  # are alarms of the joint ignored (1) or not (0)?
POSITION = 17  # q of the last tick [rad or m]
BANDWIDTH = 18  # γ [1/s]
ADDITION = 19  # torque to add to a nominal one [N·m or N]
SOFT_SIGN_WIDTH = 20  # the same as SIGN_WIDTH, where friction is compensated [rad/s or m/s]
REST_SPEED = 21  # speed below which a joint may rest [rad/s or m/s]
KNOWN_AMPLITUDE = 22  # largest torque of the model's own joint terms of late [N·m or N]
LOWEST_VELOCITY = 23  # least q̇ of the healthy runs [rad/s or m/s]
HIGHEST_VELOCITY = 24  # largest q̇ of the healthy runs [rad/s or m/s]
STEADY = 25  # 1 in motion for as long as the filter remembers, at speeds that healthy runs have had, else 0
JOINT_ROWS = 26  # their number [1]

# Rows of the part `columns`, each of shape (n, P).
PHI = 0  # φ of the last tick, torque per unit of a parameter
FILTERED = 1  # y, filtered φ
BELIEVED = 2  # ĉ, parameters of the believed faults
KNOWN = 3  # θ of the model's own joint terms
PRESENT = 4  # β of the effect's profile [1]
COLUMN_ROWS = 5  # their number [1]

# Rows of the part `phi`, each of shape (n, P): columns as the effects return them.
PHI_TICK = 0  # over the interval of the tick
PHI_UNLOADED = 1  # for a correction, at torque zero
PHI_LOADED = 2  # for a correction, at the nominal torque
PHI_ROWS = 3  # their number [1]

# Rows of the part `neurons`, each of shape (n, H).
ACTIVATION = 0  # of the last tick
ACTIVATED = 1  # filtered
WEIGHTS = 2  # learned
NEURON_ROWS = 3  # their number [1]

# Rows of the part `widths`, each of shape (n,).
OF_POSITION = 0  # [rad or m]
OF_VELOCITY = 1  # [rad/s or m/s]
SIGNAL_ROWS = 2  # their number [1]

# Entries of the part `scalars`.
TIME = 0  # of the last tick [s]
FORGET = 1  # weight that a sample keeps from tick to tick, in normal equations and amplitudes [1]
REMEMBER = 2  # the same for the normal equations of the neurons [1]
DEBOUNCE = 3  # ticks in a row beyond the threshold that raise an alarm [1]
ABSENT_TICKS = 4  # ticks without an effect's torque, where it would show, that report it as absent [1]
GAIN_FLOOR = 5  # least 1 + h that a torque is divided by [1]
LEARNS = 6  # does any joint learn an unknown fault (1) or none (0)?
CORRECTS = 7  # is the addition worked out at every tick (1) or not (0)?
DRIVEN = 8  # is an effect of torque believed in (1) or not (0)?
NEURON_COUNT = 9  # ticks since the neurons were last evaluated [1]
POSITION_NEURONS = 10  # K, radial basis functions per joint in position [1]
VELOCITY_NEURONS = 11  # L, in velocity [1]
DAMPING_NEURONS = 12  # D, in position, times velocity [1]
NEURONS = (POSITION_NEURONS, VELOCITY_NEURONS, DAMPING_NEURONS)
SCALARS = 13  # their number [1]
