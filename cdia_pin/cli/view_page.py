"""The page of ``cdia view``: opened, fed, and served until the command ends."""

from __future__ import annotations

import time
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from cdia_pin.phrases import printable

if TYPE_CHECKING:
    from cdia_pin.viewers.live import LiveView
    from cdia_pin.viewers.scene import Scene


@dataclass(frozen=True)
class Page:
    """Where to show an arm.

    Attributes:
        port: On this machine; a free one if 0.
        browser: Whether to open a browser.
    """

    port: int
    browser: bool

    @contextmanager
    def of(self, scene: Scene, **options: Any) -> Iterator[LiveView]:
        """Serve a scene while it is fed, then until the process is interrupted.

        Args:
            scene: The arm.
            **options: Of `LiveView`.
        """
        from cdia_pin.viewers.door import entrance
        from cdia_pin.viewers.live import LiveView

        with LiveView(scene, port=self.port, **options) as live:
            print(f"{printable(scene.robot.name)} moves at {live.address}  (Ctrl-C ends it)", flush=True)
            for note in scene.notes:
                print(f"drawn in part: {printable(note)}", flush=True)
            with TemporaryDirectory() as folder:
                if self.browser:
                    webbrowser.open(entrance(live.address, Path(folder)).as_uri())
                yield live
                live.finish()
                live.wait()


class Pace:
    """Lets simulated time pass no faster than asked.

    Args:
        speed: Simulated seconds in a second; 0: no limit.
    """

    def __init__(self, speed: float) -> None:
        self._speed, self._begin = speed, time.monotonic()

    def __call__(self, simulated: float) -> None:
        """Wait until a simulated time [s] has come."""
        if self._speed:
            time.sleep(max(0.0, self._begin + simulated / self._speed - time.monotonic()))
