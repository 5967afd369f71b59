"""Physically consistent parameters: the best fit among those of bodies that can exist [Wensing2018]."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.quiet_solver import solved
from cdia_pin.regression.scaled_gram import ScaledGram
from cdia_pin.robot.inertia import from_pseudo_inertia, pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Largest right-hand side given to the solver, in standard deviations [1], so that its numbers stay moderate.
LARGEST = 1e8
# Distance from the limit of physical consistency over the link's pseudo-inertia [1], against rounding.
INSIDE = 1e-7
LEAST_MASS, LEAST_RADIUS = 1e-3, 0.01  # [kg], [m]; a URDF's link may have none, but a scale must not be zero


def consistent_parameters(gram: Array, right: Array, effects: Sequence[Effect], robot: RobotModel) -> Array:
    r"""Minimise :math:`\frac12 \theta^T G \theta - r^T \theta` over physical parameters.

    Parameters stay within their bounds. The pseudo-inertia of each body together with its link stays positive
    semidefinite. The solver sees each body as this matrix x, in units of the link's mass and radius of gyration: then
    its numbers have similar sizes. It does not see parameters without a limit, which follow from the others.

    Args:
        gram: G, shape (P, P).
        right: r, shape (P,).
        effects: The effects whose parameters are in θ, in this order.
        robot: The robot.

    Returns:
        Parameters, shape (P,). Where the program cannot be solved, the physical ones next to the best of all, which
        is a worse fit.
    """
    free = ParameterBlocks.of(effects).split(ScaledGram.of(gram).solve(right))
    if all(e.is_physical(part, robot) for e, part in zip(effects, free, strict=True)):
        return np.concatenate(free)
    lower, upper = (np.concatenate(b) for b in zip(*(e.bounds(robot) for e in effects), strict=True))
    to_theta, offset, bodies = np.eye(len(right)), np.zeros(len(right)), []
    for effect, own in zip(effects, ParameterBlocks.of(effects), strict=True):
        for i, body in enumerate(effect.bodies):
            at = slice(own.start + 10 * i, own.start + 10 * (i + 1))
            to_theta[at, at], offset[at] = _from_matrix(body, robot)
            bodies.append(at)
    scaled = ScaledGram.of(to_theta.T @ gram @ to_theta)
    to_theta = to_theta * scaled.unit
    limited = np.isfinite(lower) | np.isfinite(upper)
    for at in bodies:
        limited[at] = True
    if not limited.any():
        return ScaledGram.of(gram).solve(right)
    # parameters without a limit are eliminated: y_free = best - slope @ y_limited
    matrix, b = scaled.matrix, to_theta.T @ (right - gram @ offset)
    across = matrix[np.ix_(~limited, limited)]
    eliminated = np.linalg.solve(matrix[np.ix_(~limited, ~limited)], np.column_stack([across, b[~limited]]))
    slope, best = eliminated[:, :-1], eliminated[:, -1]
    reduced = ScaledGram.of(matrix[np.ix_(limited, limited)] - across.T @ slope)
    to_bounds, to_bodies = (
        to_theta[:, limited] * reduced.unit,
        np.zeros((10 * len(bodies), int(limited.sum()))),
    )
    units = np.where(limited, scaled.unit, 0.0)[limited] * reduced.unit
    for k, at in enumerate(bodies):
        of_body = np.zeros(len(right), bool)
        of_body[at] = True
        columns = np.flatnonzero(of_body[limited])
        to_bodies[np.arange(10 * k, 10 * k + 10), columns] = units[columns]
    y = _solution(
        reduced,
        reduced.unit * (b[limited] - across.T @ best),
        [(to_bounds[np.isfinite(upper)], (upper - offset)[np.isfinite(upper)]),
         (-to_bounds[np.isfinite(lower)], (offset - lower)[np.isfinite(lower)])],
        to_bodies,
    )  # fmt: skip
    if y is None:
        return np.concatenate([e.nearest_physical(p, robot) for e, p in zip(effects, free, strict=True)])
    whole = np.empty(len(right))
    whole[limited] = reduced.unit * y
    whole[~limited] = best - slope @ whole[limited]
    return np.asarray(np.clip(to_theta @ whole + offset, lower, upper))


def _solution(
    gram: ScaledGram, right: Array, bounds: Sequence[tuple[Array, Array]], bodies: Array
) -> Array | None:
    """Return y of least ½ yᵀ S y − rᵀ y with A y ≤ b and positive semidefinite bodies, None if the solver fails.

    Args:
        gram: S, shape (Q, Q).
        right: r, shape (Q,).
        bounds: A, shape (m, Q), and b, shape (m,).
        bodies: Ten rows per body that give the triangle of its matrix, shape (10 × bodies, Q).
    """
    import clarabel
    from scipy import sparse

    # without noise, the solver's numbers would be huge
    size = max(float(np.abs(right).max()) / LARGEST, 1.0)
    rows = np.vstack([*(a for a, _ in bounds), -bodies])
    limits = np.concatenate([*(b for _, b in bounds), np.zeros(len(bodies))])
    cones = [clarabel.NonnegativeConeT(len(limits) - len(bodies))] if len(limits) > len(bodies) else []
    cones += [clarabel.PSDTriangleConeT(4)] * (len(bodies) // 10)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    # The diagonal is one already: scaled once more, 305 programs of a Panda's log take 15 steps in place of 11.
    settings.equilibrate_enable = False
    found = solved(
        lambda: clarabel.DefaultSolver(
            sparse.csc_matrix(np.triu(gram.matrix)),
            -right / size,
            sparse.csc_matrix(rows),
            limits / size,
            cones,
            settings,
        )
    )
    return None if found is None else size * found


@lru_cache(maxsize=256)
def _from_matrix(body: RigidBody, robot: RobotModel) -> tuple[Array, Array]:
    """Return A and b with θ = A x + b.

    x is the triangle of the pseudo-inertia of body and link less the smallest one allowed, in units of the link's mass
    and radius of gyration. A congruence by these units leaves it positive semidefinite.

    Args:
        body: The body.
        robot: The robot.

    Returns:
        Shapes (10, 10) and (10,).
    """
    link = body.total(np.zeros(10), robot)
    matrix = pseudo_inertia(link)
    mass = max(float(matrix[3, 3]), LEAST_MASS)
    radius = np.sqrt(max(float(np.trace(matrix[:3, :3])) / mass, LEAST_RADIUS**2))
    units = np.sqrt(mass) * np.diag([radius, radius, radius, 1.0])
    smallest = INSIDE * max(float(np.abs(matrix).max()), 1e-6) * np.eye(4)
    to_joint = np.array([from_pseudo_inertia(units @ m @ units) for m in _matrices()]).T
    from_joint = np.linalg.inv(body.to_joint_frame(robot))
    return from_joint @ to_joint, from_joint @ (from_pseudo_inertia(smallest) - link)


def _matrices() -> list[Array]:
    """Return the symmetric matrices that the ten entries of a triangle stand for, shape (4, 4) each.

    The solver has the upper triangle by columns, off-diagonals times √2: then its inner product is the matrices'.
    """
    out = []
    for j in range(4):
        for i in range(j + 1):
            m = np.zeros((4, 4))
            m[i, j] = m[j, i] = 1.0 if i == j else np.sqrt(0.5)
            out.append(m)
    return out
