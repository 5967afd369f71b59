"""Physically consistent parameters: the best fit among those of bodies that can exist [Wensing2018]."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.inertia import pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Largest right-hand side given to the solver, in standard deviations [1], so that its numbers stay moderate.
LARGEST = 1e8
# Distance from the limit of physical consistency over the link's pseudo-inertia [1], against rounding.
INSIDE = 1e-7


def consistent_parameters(gram: Array, right: Array, effects: Sequence[Effect], robot: RobotModel) -> Array:
    r"""Minimise :math:`\frac12 \theta^T G \theta - r^T \theta` over physical parameters.

    Parameters stay within their bounds. The pseudo-inertia of each body together with its link stays positive
    semidefinite.

    Args:
        gram: G, shape (P, P).
        right: r, shape (P,).
        effects: The effects whose parameters are in θ, in this order.
        robot: The robot.

    Returns:
        Parameters, shape (P,). Where the program cannot be solved, the physical ones next to the best of all, which
        is a worse fit.
    """
    import clarabel
    from scipy import sparse

    scaled = ScaledGram.of(gram)
    unit = scaled.unit
    # without noise, the solver's numbers would be huge
    size = max(np.abs(unit * right).max() / LARGEST, 1.0)
    lower, upper = (np.concatenate(b) for b in zip(*(e.bounds(robot) for e in effects), strict=True))
    rows, offsets, cones = [], [], []
    eye = np.eye(len(right))
    for sign, bound in ((1.0, upper), (-1.0, lower)):
        finite = np.isfinite(bound)
        if finite.any():
            rows.append(sign * eye[finite])
            offsets.append(sign * bound[finite])
            cones.append(clarabel.NonnegativeConeT(int(finite.sum())))
    for effect, own in zip(effects, ParameterBlocks.of(effects), strict=True):
        for i, body in enumerate(effect.bodies):
            block = np.zeros((10, len(right)))
            start = _triangle(pseudo_inertia(body.total(np.zeros(10), robot)))
            for k, one in enumerate(np.eye(10)):
                block[:, own.start + 10 * i + k] = _triangle(pseudo_inertia(body.in_joint_frame(one, robot)))
            rows.append(-block)
            offsets.append(start - INSIDE * _triangle(np.eye(4)) * max(abs(start).max(), 1e-6))
            cones.append(clarabel.PSDTriangleConeT(4))
    if not cones:
        return scaled.solve(right)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solution = _solution(
        sparse.csc_matrix(np.triu(scaled.matrix)),
        -unit * right / size,
        sparse.csc_matrix(np.vstack(rows) * unit),
        np.concatenate(offsets) / size,
        cones,
        settings,
    )
    if solution is None:
        parts = ParameterBlocks.of(effects).split(scaled.solve(right))
        return np.concatenate([e.nearest_physical(p, robot) for e, p in zip(effects, parts, strict=True)])
    return np.asarray(np.clip(unit * size * solution, lower, upper))


def _solution(*problem: object) -> Array | None:
    """Return the solver's numbers; None if it refused the problem, found none, or panicked."""
    import clarabel

    try:
        solution = clarabel.DefaultSolver(*problem).solve()
    except Exception:
        return None
    except BaseException as panic:  # what Rust calls a panic is no Exception
        if type(panic).__name__ != "PanicException":
            raise
        return None
    if str(solution.status) not in {"Solved", "AlmostSolved"}:
        return None
    numbers = np.array(solution.x)
    return numbers if np.isfinite(numbers).all() else None


def _triangle(matrix: Array) -> Array:
    """Upper triangle by columns, off-diagonals times √2: the solver's inner product is then the matrices'."""
    out = [matrix[i, j] * (1.0 if i == j else np.sqrt(2.0)) for j in range(len(matrix)) for i in range(j + 1)]
    return np.array(out)
