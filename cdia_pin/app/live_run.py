"""`LiveRun`: an arm that moves in a thread at the pace of a clock, and the frames of its picture."""

from __future__ import annotations

import threading
import time

import numpy as np

from cdia_pin.app.frame_history import FrameHistory
from cdia_pin.app.live_sources import Source
from cdia_pin.diagnosis import Event, Status
from cdia_pin.diagnosis.event_history import MOST_EVENTS
from cdia_pin.errors import CdiaError
from cdia_pin.fault_report import fault_sentence, is_fault
from cdia_pin.viewers.live import FrameMaker
from cdia_pin.viewers.scene import Frame

FRAMES = 20.0  # [Hz]
LATE = 0.25  # [s], by which the clock may be missed before it is set anew


class LiveRun:
    """Runs a source until it ends or is stopped.

    Args:
        source: What moves.
        replay: Whether desired positions are unknown, as in a log.

    Attributes:
        frames: What is drawn, the last `frame_history.KEPT` frames.
        events: The monitor's last events; another tuple each time that one is added.
        error: Why it ended, in a sentence; empty if it did not fail.
        speed: Time of the arm over time of the clock [1].
    """

    def __init__(self, source: Source, *, replay: bool = False) -> None:
        self.source, self.error, self.speed = source, "", 1.0
        self._replay = replay
        self.frames = FrameHistory()
        self.events: tuple[Event, ...] = ()
        self._stop, self._goes = threading.Event(), threading.Event()
        self._goes.set()
        self._thread = threading.Thread(target=self._run, name="cdia live", daemon=True)
        self._thread.start()

    @property
    def ended(self) -> bool:
        """Whether nothing moves any more."""
        return not self._thread.is_alive()

    @property
    def paused(self) -> bool:
        """Whether it waits."""
        return not self._goes.is_set()

    def stop(self) -> None:
        """End the run."""
        self._stop.set()
        self._goes.set()

    def pause(self, waits: bool) -> None:
        """Pause, or go on.

        Args:
            waits: Whether to pause.
        """
        self._goes.clear() if waits else self._goes.set()

    def _run(self) -> None:
        try:
            self._follow()
        except CdiaError as error:
            self.error = " ".join(str(error).split())
        except BaseException as error:
            if not is_fault(error):
                raise
            fault = fault_sentence(error, "cdia app: an arm that moves")
            self.error = f"{fault}. Begin anew, with other faults or another log."

    def _follow(self) -> None:
        frame_of = FrameMaker(self.source.robot, rate=FRAMES)
        begun = wall = shown = None
        for tick in self.source.ticks:
            status = tick.status
            if self._stop.is_set() or status is None:
                return
            if status.events:
                self.events = (*self.events, *status.events)[-MOST_EVENTS:]
            frame = frame_of(tick.time, tick.q, status, None if self._replay else tick.desired)
            if frame is None:
                continue
            self.frames.add(frame | _signals(status))
            if not self._goes.is_set():
                self._goes.wait()
                begun = None
            now = time.monotonic()
            if shown is not None and wall is not None and now > wall:
                self.speed += 0.05 * ((tick.time - shown) / (now - wall) - self.speed)
            if begun is None or now - begun > tick.time + LATE:
                begun = now - tick.time
            time.sleep(max(begun + tick.time - now, 0.0))
            wall, shown = now, tick.time


def _signals(status: Status) -> Frame:
    """Return residual and threshold of each joint, as a page draws them."""
    return {
        "residual": [np.round(status.residual, 4).tolist()],
        "threshold": [np.round(status.threshold, 4).tolist()],
    }
