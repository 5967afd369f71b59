"""How large an effect is: its torque as a share of what the joint carries anyway."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.insertion import Insertion
from cdia_pin.effects import Term

Array = NDArray[np.float64]

LARGEST = {  # beyond these an effect is none that a working robot has
    "encoder_offset": 0.2,  # [rad or m]
    "effort_delay": 0.1,  # [s]
    "actuator_gain": 0.5,  # [1], either way
    "load_friction": 0.5,  # [1]
}
TOLERANCE = 0.02  # [1], by which a size may miss what was asked for
STEPS = 12  # most corrections; effects that are linear in their parameters need one
TELLING = 0.2  # [1], share of an effect's torque from which a parameter says how large it is


class NoSizeError(ValueError):
    """An effect cannot have a size on this motion."""


def share(term: Term, along: FilteredLog) -> float:
    """Return the RMS torque of an effect over that of the joint on which it is largest [1].

    Args:
        term: The effect with its numbers.
        along: The log it is put into.
    """
    size = along.size(Insertion(term, along).torque())
    j = int(np.argmax(size))
    return float(size[j] / along.torque_rms[j])


def sized(term: Term, wanted: float, along: FilteredLog) -> Term:
    """Return the effect scaled to a share.

    Args:
        term: The effect at any size.
        wanted: RMS torque over that of the joint on which it is largest [1].
        along: The log it is put into.

    Raises:
        NoSizeError: If it cannot have that size and be one that a working robot has.
    """
    for _ in range(STEPS):
        now = share(term, along)
        if now <= 0:
            break
        if abs(now / wanted - 1.0) <= TOLERANCE:
            return term
        larger = term.with_theta(_limited(term.effect.name, np.array(term.theta) * wanted / now))
        if larger == term:  # as large as it may be
            break
        term = larger
    raise NoSizeError(f"{term.label} cannot have {wanted:.0%} of the joint's torque in {along.log.source}")


def telling(term: Term, along: FilteredLog) -> tuple[str, ...]:
    """Return the parameters that say how large an effect is: those that make much of its torque.

    A payload is as large as its mass. No single parameter of a link tells: a torque shows combinations of them.

    Args:
        term: The effect with its numbers.
        along: The log it is put into.
    """
    name = term.effect.name
    if name in {"payload", "link_inertia"}:
        return ("mass",) if name == "payload" else ()
    whole = along.size(term.torque(along.state)).max()
    out = []
    for i, p in enumerate(term.effect.parameters):
        alone = term.with_theta(np.where(np.arange(term.effect.size) == i, term.theta, 0.0))
        if along.size(alone.torque(along.state)).max() >= TELLING * whole:
            out.append(p.name)
    return tuple(out)


def _limited(name: str, theta: Array) -> Array:
    most = LARGEST.get(name, np.inf)
    return np.asarray(np.clip(theta, -most, most))
