"""A run's residual against its motion, with the torque of the faults believed in; where the plant has which fault."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import Stage
from cdia_pin.effects.state import State
from cdia_pin.viewers.report_isolation import Span, span_of
from cdia_pin.viewers.report_series import Curve, Numbers, compact, curve_of
from cdia_pin.viewers.words import effect_name

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.effects import Term

Array = NDArray[np.float64]

FAULTY = [STAGES.index(s) for s in (Stage.DETECTED, Stage.ISOLATED, Stage.ACCOMMODATED)]
FEWEST = 50  # ticks that are worth a picture


class SignalDocument(TypedDict):
    """A signal while the joint is at fault (``x``) and while it is healthy; the fitted torque over it."""

    x: Numbers
    healthy: Numbers
    curve: Curve | None


class AgainstMotion(TypedDict):
    """Residual of a joint against its motion."""

    fitted: list[str]
    residual: Numbers
    healthy: Numbers
    signals: dict[str, SignalDocument]


def motion_of(run: MonitorRun) -> State:
    """Return the motion of a run as effects see it; velocity and acceleration differentiated where they must be."""
    v = np.gradient(run.position, run.time, axis=0) if run.velocity is None else run.velocity
    a = np.gradient(v, run.time, axis=0)
    return State(run.robot, run.position, v, a, run.effort, run.time)


def presence(run: MonitorRun, x: State, j: int, present: Sequence[Term]) -> list[Span]:
    """Return [from, to, effect] wherever the plant has a fault on a joint.

    Args:
        run: The run.
        x: Its motion.
        j: The joint.
        present: Faults of the plant.
    """
    spans = []
    for term in present:
        if run.joints[j] not in term.effect.joints(run.robot):
            continue
        edge = np.diff(np.concatenate([[0], (term.profile(x) > 0.5).astype(int), [0]]))
        for begin, end in zip(np.flatnonzero(edge == 1), np.flatnonzero(edge == -1) - 1, strict=True):
            spans.append(span_of(run.time[begin], run.time[end], effect_name(term.effect)))
    return spans


def against_motion(run: MonitorRun, x: State, j: int, points: int) -> AgainstMotion | None:
    """Return a joint's residual against position, velocity and torque while it is at fault, and the fitted torque.

    The curve is the torque of the faults that were last believed in on this joint. It is None where that is no
    function of the signal. Of residuals that are no torques, or too few, there is nothing to show.
    """
    faulty = np.isin(run.stages[:, j], FAULTY)
    if not run.in_torque or faulty.sum() < FEWEST:
        return None
    use = np.flatnonzero(faulty)
    thin = use[:: -(-len(use) // points) or 1]
    healthy = np.flatnonzero(~faulty)
    rest = healthy[:: -(-len(healthy) // points) or 1]
    believed = next((own for b in reversed(run.beliefs) if (own := _on(b.faults, run.joints[j]))), ())
    fitted = sum((t.torque(x)[use, j] for t in believed), np.zeros(len(use)))
    signals = {"position": x.q, "velocity": x.v, "load": x.effort}
    return {
        "fitted": [effect_name(t.effect) for t in believed],
        "residual": compact(run.residual[thin, j]),
        "healthy": compact(run.residual[rest, j]),
        "signals": {
            name: {
                "x": compact(s[thin, j]),
                "healthy": compact(s[rest, j]),
                "curve": curve_of(s[use, j], fitted) if believed else None,
            }
            for name, s in signals.items()
        },
    }


def _on(terms: Sequence[Term], joint: str) -> tuple[Term, ...]:
    return tuple(t for t in terms if joint in t.effect.scope)
