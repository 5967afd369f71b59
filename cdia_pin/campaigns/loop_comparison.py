"""The same motion healthy, with faults, and with faults under a monitor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopRun
from cdia_pin.diagnosis import Monitor
from cdia_pin.effects import Term
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]
Tell = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Comparison:
    """The same motion three times.

    Attributes:
        loop: Plant and sensors.
        since: From when on tracking is compared [s].
        healthy: Without faults.
        faulty: With them, uncorrected; None where the arm ran away.
        monitored: With them and a monitor; the same as `faulty` if it only watches.
    """

    loop: ClosedLoop
    since: float
    healthy: LoopRun
    faulty: LoopRun | None
    monitored: LoopRun

    def tracking(self) -> dict[str, Array]:
        """Return the RMS of the tracking error of each run [rad or m], shape (n,) each; inf where it ran away."""
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
    progress: Tell = lambda sentence, share: None,
) -> Comparison:
    """Run a motion without faults, with them, and with them under a monitor.

    Args:
        loop: Plant and sensors.
        monitor: Of `ClosedLoop.monitor`.
        faults: What breaks.
        duration: Length of the motion [s].
        since: From when on tracking is compared [s]; when the first fault begins if omitted.
        progress: Told what is done, and the share that is done.

    Raises:
        ModelError: If the arm runs away, healthy or under the monitor.
    """
    motion = loop.motion(0, duration)
    since = onset(faults) if since is None else since

    def tell(sentence: str, which: int) -> Callable[[float], None]:
        return lambda share: progress(sentence, (which + share) / 3)

    healthy = loop.run(motion, progress=tell("healthy", 0))
    faulty: LoopRun | None
    if not monitor.record["settings"]["accommodate"]:
        faulty = loop.run(motion, faults, monitor, progress=tell("with faults, watched", 1))
        return Comparison(loop, since, healthy, faulty, faulty)
    try:
        faulty = loop.run(motion, faults, progress=tell("with faults, uncorrected", 1))
    except ModelError:  # it runs away
        faulty = None
    monitored = loop.run(motion, faults, monitor, progress=tell("with faults, under the monitor", 2))
    return Comparison(loop, since, healthy, faulty, monitored)


def onset(faults: Sequence[Term]) -> float:
    """Return when the first fault begins [s]; 0 where one is always there, or none."""
    starts = [float(getattr(f.profile, "start", 0.0)) for f in faults]
    return max(0.0, min(starts, default=0.0))
