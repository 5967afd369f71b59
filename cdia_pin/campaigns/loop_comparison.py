"""Comparison of a motion without faults, with faults, and with faults under a monitor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopRun
from cdia_pin.diagnosis import Monitor
from cdia_pin.effects import Term
from cdia_pin.errors import ModelError
from cdia_pin.phrases import shortened
from cdia_pin.progress import Progress, silent

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class LoopComparison:
    """Three runs of the same motion.

    Attributes:
        loop: Plant and sensors.
        since: Start of the comparison of tracking [s].
        healthy: Run without faults.
        faulty: Run with faults and without compensation; None if it diverged.
        monitored: Run with faults and a monitor; the same as `faulty` if the monitor does not compensate.
    """

    loop: ClosedLoop
    since: float
    healthy: LoopRun
    faulty: LoopRun | None
    monitored: LoopRun

    def __repr__(self) -> str:
        return f"LoopComparison({shortened(self.loop.robot.name)}, {', '.join(self.tracking())})"

    def tracking(self) -> dict[str, Array]:
        """Return the RMS tracking error of each run by its name [rad or m], shape (n,) each; inf if it diverged."""
        lost = np.full(self.loop.robot.n, np.inf)
        runs = {"healthy": self.healthy, "faulty": self.faulty}
        if self.monitored is not self.faulty:
            runs["accommodated"] = self.monitored
        return {name: lost if r is None else r.tracking(self.since) for name, r in runs.items()}


def compare_loops(
    loop: ClosedLoop,
    monitor: Monitor,
    faults: Sequence[Term],
    duration: float,
    *,
    since: float | None = None,
    progress: Progress = silent,
) -> LoopComparison:
    """Run a motion without faults, with them, and with them under a monitor.

    Args:
        loop: Plant and sensors.
        monitor: Result of `ClosedLoop.monitor`.
        faults: True faults.
        duration: Length of the motion [s].
        since: Start of the comparison of tracking [s]; the onset of the first fault if omitted.
        progress: Called with the current work and the share that is done [1].

    Returns:
        The three runs.

    Raises:
        ModelError: If the run without faults or the run under the monitor diverges.
    """
    motion = loop.motion(0, duration)
    since = onset(faults) if since is None else since

    def tell(sentence: str, which: int) -> Callable[[float], None]:
        return lambda share: progress(sentence, (which + share) / 3)

    healthy = loop.run(motion, progress=tell("healthy", 0))
    faulty: LoopRun | None
    if not monitor.record["settings"]["accommodate"]:
        faulty = loop.run(motion, faults, monitor, progress=tell("with faults, watched", 1))
        return LoopComparison(loop, since, healthy, faulty, faulty)
    try:
        faulty = loop.run(motion, faults, progress=tell("with faults, not compensated", 1))
    except ModelError:  # the simulation diverged
        faulty = None
    monitored = loop.run(motion, faults, monitor, progress=tell("with faults, under the monitor", 2))
    return LoopComparison(loop, since, healthy, faulty, monitored)


def onset(faults: Sequence[Term]) -> float:
    """Return the onset of the first fault.

    Args:
        faults: True faults.

    Returns:
        Time [s]; 0 without faults, or if one is always present.
    """
    starts = [float(getattr(f.profile, "start", 0.0)) for f in faults]
    return max(0.0, min(starts, default=0.0))
