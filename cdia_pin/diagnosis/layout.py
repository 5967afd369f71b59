"""The one array that holds the state of all joints, and its parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import JointEffect

Array = NDArray[np.float64]
Shape = tuple[int, ...]


def layout(n: int, effects: Sequence[JointEffect], neurons: int) -> dict[str, Shape]:
    """Return the shape of each part of the state of n joints, in its order.

    Args:
        n: Number of joints.
        effects: Effects whose columns are filtered.
        neurons: Radial basis functions per joint, in position and in velocity each.
    """
    from cdia_pin.diagnosis import kernels as k

    P, hidden = sum(e.size for e in effects), 2 * neurons + 1
    return {
        "scalars": (k.SCALARS,),
        "joint": (k.JOINT_ROWS, n),
        "columns": (k.COLUMN_ROWS, n, P),
        "gram": (n, P + 1, P + 1),
        "absent": (n, len(effects)),
        "mass": (n, n),
        "phi": (3, n, P),  # of the tick, and for corrections without and with torque
        "centres": (2, neurons, n),
        "widths": (2, n),
        "neurons": (k.NEURON_ROWS, n, hidden),
        "neuron_gram": (n, hidden + 1, hidden + 1),
    }


def spans(parts: Mapping[str, Shape]) -> Iterator[tuple[str, int, int, Shape]]:
    """Yield name, begin, end and shape of each part."""
    end = 0
    for name, shape in parts.items():
        begin, end = end, end + int(np.prod(shape))
        yield name, begin, end, shape


def allocate(parts: Mapping[str, Shape]) -> tuple[Array, dict[str, Array]]:
    """Return the array, all zero, and a view of each part."""
    state = np.zeros(sum(int(np.prod(shape)) for shape in parts.values()))
    return state, {name: state[a:b].reshape(shape) for name, a, b, shape in spans(parts)}
