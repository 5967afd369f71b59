r"""Inertial parameters of a rigid body: changes of frame and physical consistency.

The ten parameters of a body, in Pinocchio's order and about the origin of their frame:

.. math:: \pi = (m,\; m c_x,\; m c_y,\; m c_z,\; I_{xx},\; I_{xy},\; I_{yy},\; I_{xz},\; I_{yz},\; I_{zz})

mass [kg], first moments [kg·m], second moments [kg·m²]. They are linear in the pseudo-inertia

.. math:: J(\pi) = \begin{bmatrix} \Sigma & m c \\ m c^\top & m \end{bmatrix}, \qquad
          \Sigma = \tfrac12 \mathrm{tr}(I)\, 1 - I = \int \rho\, x x^\top dV

and a mass distribution with these parameters exists if and only if J is positive semidefinite [Wensing2018]_.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError

Array = NDArray[np.float64]

N_PARAMETERS = 10
PARAMETER_NAMES = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
PARAMETER_UNITS = ("kg",) + ("kg·m",) * 3 + ("kg·m²",) * 6

# Row and column of the six second moments in Pinocchio's order: the lower triangle, row by row.
_ROW = np.array([0, 1, 1, 2, 2, 2])
_COLUMN = np.array([0, 0, 1, 0, 1, 2])


def pseudo_inertia(parameters: ArrayLike) -> Array:
    """Compute the pseudo-inertia J(π) of a body [Wensing2018]_; it is linear in π.

    Args:
        parameters: The ten parameters, shape (..., 10).

    Returns:
        Symmetric matrices, shape (..., 4, 4): second moments Σ [kg·m²], first moments [kg·m], mass [kg].
    """
    p = _ten(parameters)
    inertia = rotational_inertia(p)
    J = np.empty((*p.shape[:-1], 4, 4))
    J[..., :3, :3] = 0.5 * np.trace(inertia, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - inertia
    J[..., :3, 3] = J[..., 3, :3] = p[..., 1:4]
    J[..., 3, 3] = p[..., 0]
    return J


def from_pseudo_inertia(J: ArrayLike) -> Array:
    """Compute the parameters π of a pseudo-inertia: the inverse of ``pseudo_inertia``.

    Args:
        J: Symmetric matrices, shape (..., 4, 4), units as ``pseudo_inertia``.

    Returns:
        The ten parameters, shape (..., 10).
    """
    J = np.asarray(J, dtype=np.float64)
    if J.shape[-2:] != (4, 4):
        raise RobotError(f"a pseudo-inertia has the shape (..., 4, 4), given {J.shape}")
    second = J[..., :3, :3]
    inertia = np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second
    out = np.empty((*J.shape[:-2], N_PARAMETERS))
    out[..., 0] = J[..., 3, 3]
    out[..., 1:4] = J[..., :3, 3]
    out[..., 4:] = inertia[..., _ROW, _COLUMN]
    return out


def rotational_inertia(parameters: ArrayLike) -> Array:
    """Compute the inertia tensor about the frame's origin.

    Args:
        parameters: The ten parameters, shape (..., 10).

    Returns:
        Tensors [kg·m²], shape (..., 3, 3).
    """
    p = _ten(parameters)
    inertia = np.empty((*p.shape[:-1], 3, 3))
    inertia[..., _ROW, _COLUMN] = p[..., 4:]
    inertia[..., _COLUMN, _ROW] = p[..., 4:]
    return inertia


def parameters_of(mass: float, com: ArrayLike, inertia_at_com: ArrayLike) -> Array:
    """Compute the parameters about the frame's origin from the values that a URDF or data sheet states.

    Args:
        mass: Mass [kg].
        com: Centre of mass in the frame [m], shape (3,).
        inertia_at_com: Inertia tensor about the centre of mass, axes of the frame [kg·m²], shape (3, 3).

    Returns:
        The ten parameters, shape (10,).
    """
    c = np.asarray(com, dtype=np.float64)
    # Steiner: the tensor about the origin exceeds the one about the centre of mass by m (|c|² 1 − c cᵀ).
    inertia = np.asarray(inertia_at_com, dtype=np.float64) + mass * (c @ c * np.eye(3) - np.outer(c, c))
    return np.concatenate([[mass], mass * c, inertia[_ROW, _COLUMN]])


def at_centre_of_mass(parameters: ArrayLike) -> tuple[float, Array, Array]:
    """Compute what a URDF states: mass, centre of mass, and the inertia tensor about the centre of mass.

    Args:
        parameters: The ten parameters of one body, shape (10,).

    Returns:
        Mass [kg], centre of mass [m], shape (3,), and inertia tensor [kg·m²], shape (3, 3).

    Raises:
        RobotError: If the body has first moments but no mass: it has no centre of mass.
    """
    p = _ten(parameters)
    mass = float(p[0])
    if mass == 0.0:
        if np.any(p[1:4] != 0.0):
            raise RobotError(f"a body of mass 0 cannot have first moments, given {p[1:4].tolist()} kg·m")
        return 0.0, np.zeros(3), rotational_inertia(p)
    c = p[1:4] / mass
    return mass, c, rotational_inertia(p) - mass * (c @ c * np.eye(3) - np.outer(c, c))


def transform_parameters(pose: ArrayLike) -> Array:
    """Compute the matrix A with π_joint = A π_frame, from J_joint = T J_frame Tᵀ [Wensing2018]_.

    A regressor in the joint frame becomes one in the other frame by Y_frame = Y_joint A. A payload can so be
    estimated in the axes of the tool that carries it.

    Args:
        pose: T, homogeneous pose of the frame in the joint frame, shape (4, 4) [1, m].

    Returns:
        A, shape (10, 10), in products of m.
    """
    T = np.asarray(pose, dtype=np.float64)
    if T.shape != (4, 4):
        raise RobotError(f"a pose is a homogeneous matrix of shape (4, 4), given {T.shape}")
    basis = pseudo_inertia(np.eye(N_PARAMETERS))
    return from_pseudo_inertia(T @ basis @ T.T).T


def physical_margin(parameters: ArrayLike) -> Array:
    """Compute the smallest second moment about the centre of mass, relative to the trace of Σ.

    It is at least 0 for a body that can exist, exactly 0 for points, rods and flat plates, and negative where
    the principal moments break the triangle inequality. It is taken from the Schur complement of the mass in J,
    because the eigenvalues of J itself mix kg and kg·m².

    Args:
        parameters: The ten parameters, shape (..., 10).

    Returns:
        Margin [1], shape (...); −inf where the mass is negative, or 0 with first moments.
    """
    J = pseudo_inertia(parameters)
    mass, first, second = J[..., 3, 3], J[..., :3, 3], J[..., :3, :3]
    scale = np.trace(second, axis1=-2, axis2=-1)
    safe = np.where(mass > 0, mass, 1.0)
    central = second - first[..., :, None] * first[..., None, :] / safe[..., None, None]
    smallest = np.linalg.eigvalsh(central)[..., 0]
    # scale ≤ 0 occurs only for a point at the origin (then the margin is 0) or for a body that cannot exist.
    margin = smallest / np.where(scale > 0, scale, 1.0)
    no_body = (mass < 0) | ((mass == 0) & np.any(first != 0, axis=-1))
    return np.where(no_body, -np.inf, margin)


def is_physical(parameters: ArrayLike, tol: float = 1e-9) -> NDArray[np.bool_]:
    """Tell whether a mass distribution with these parameters exists: J(π) ⪰ 0 [Wensing2018]_.

    Args:
        parameters: The ten parameters, shape (..., 10).
        tol: Size of a negative ``physical_margin`` that counts as rounding [1].

    Returns:
        True for physically consistent bodies, shape (...); a NumPy bool for one body.
    """
    p = _ten(parameters)
    return np.asarray(np.all(np.isfinite(p), axis=-1) & (physical_margin(np.nan_to_num(p)) >= -tol))


def _ten(parameters: ArrayLike) -> Array:
    p = np.asarray(parameters, dtype=np.float64)
    if p.shape[-1:] != (N_PARAMETERS,):
        names = ", ".join(PARAMETER_NAMES)
        raise RobotError(f"a body has {N_PARAMETERS} inertial parameters ({names}), given shape {p.shape}")
    return p
