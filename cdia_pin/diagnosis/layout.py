"""The layout of the observer's state: one array, and the shapes of its named parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import kernel_rows as rows
from cdia_pin.effects import JointEffect

Array = NDArray[np.float64]
Shape = tuple[int, ...]


def sides(effects: Sequence[JointEffect]) -> dict[str, tuple[int | str, ...]]:
    """Return the sides of each part of the state, in the order of the parts.

    What differs from arm to arm stays a name, so that all arms share the compiled code: n joints, per joint K radial
    basis functions in position, L in velocity and D of damping, H = K + L + D + 1 neurons, H1 = H + 1.

    Args:
        effects: Effects whose columns are filtered, with P parameters together.
    """
    P = sum(e.size for e in effects)
    return {
        "scalars": (rows.SCALARS,),
        "joint": (rows.JOINT_ROWS, "n"),
        "columns": (rows.COLUMN_ROWS, "n", P),
        "gram": ("n", P + 1, P + 1),
        "absent": ("n", len(effects)),
        "mass": ("n", "n"),
        "phi": (rows.PHI_ROWS, "n", P),
        "position_centres": ("K", "n"),
        "velocity_centres": ("L", "n"),
        "damping_centres": ("D", "n"),
        "widths": (rows.SIGNAL_ROWS, "n"),
        "neurons": (rows.NEURON_ROWS, "n", "H"),
        "neuron_gram": ("n", "H1", "H1"),
    }


def layout(n: int, effects: Sequence[JointEffect], neurons: Sequence[int]) -> dict[str, Shape]:
    """Return the shape of each part of the state of n joints, in the order of the parts.

    Args:
        n: Number of joints.
        effects: Effects whose columns are filtered, with P parameters together.
        neurons: Neurons of each kind per joint, as `Unknown.counts` has them.
    """
    K, L, D, _ = neurons
    H = sum(neurons)
    named = {"n": n, "K": K, "L": L, "D": D, "H": H, "H1": H + 1}
    return {
        part: tuple(named[side] if isinstance(side, str) else side for side in shape)
        for part, shape in sides(effects).items()
    }


def spans(parts: Mapping[str, Shape]) -> Iterator[tuple[str, int, int, Shape]]:
    """Yield name, begin, end and shape of each part in the array.

    Args:
        parts: Shapes by name, as `layout` returns them.
    """
    end = 0
    for name, shape in parts.items():
        begin, end = end, end + int(np.prod(shape))
        yield name, begin, end, shape


def allocate(parts: Mapping[str, Shape]) -> tuple[Array, dict[str, Array]]:
    """Return the array, all zero, and a view of each part.

    Args:
        parts: Shapes by name, as `layout` returns them.
    """
    state = np.zeros(sum(int(np.prod(shape)) for shape in parts.values()))
    return state, {name: state[a:b].reshape(shape) for name, a, b, shape in spans(parts)}
