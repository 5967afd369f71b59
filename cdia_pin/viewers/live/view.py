"""`LiveView`: frames of a moving arm to a browser, from a thread of this process."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from cdia_pin.errors import CdiaError
from cdia_pin.extras import require
from cdia_pin.viewers.live.server import Stream, application
from cdia_pin.viewers.scene import Frame, Scene, SceneStage, Timeline

HOST = "127.0.0.1"
PATIENCE = 30.0  # [s] for the server to begin, which a busy machine may need; one that cannot says so at once
LAST = 2.0  # [s] for it to end


class LiveView:
    """A page that shows an arm, served to who has its address for as long as the process and the view live.

        with LiveView(Scene.of(robot), stages=monitor_stages()) as view:
            print(view.address)
            while moving:
                view.show(frame)          # of a `FrameMaker`, at 30 Hz or less

    Args:
        scene: The arm.
        position: Pose to begin with [rad or m], shape (n,).
        reach: Positions to come, for the camera to have them in view [rad or m], shape (K, n).
        stages: What the numbers of stages mean.
        follow: Whether the page shows the newest frame, and not all of them from the beginning.
        timeline: A motion that is known already; then no frames are shown.
        title: Of the page.
        port: Where to serve; a free one if 0.

    Raises:
        CdiaError: If the port cannot be had.
        MissingExtraError: If the server's packages are not installed.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        position: ArrayLike | None = None,
        reach: ArrayLike | None = None,
        stages: Sequence[SceneStage] = (),
        follow: bool = True,
        timeline: Timeline | None = None,
        title: str = "",
        port: int = 0,
    ) -> None:
        require("view", "live views")
        import uvicorn

        from cdia_pin.viewers.door import new_token

        live: dict[str, object] = {"live": True, "follow": follow, "stages": [s.to_dict() for s in stages]}
        if reach is not None:
            live["reach"] = np.round(np.asarray(reach, float), 3).tolist()
        setup = {
            "title": title or scene.robot.name,
            "scene": scene.to_dict(position),
            "timeline": live if timeline is None else timeline.to_dict(),
        }
        self._stream = Stream()
        self._socket = _bound(port)
        port, token = self._socket.getsockname()[1], new_token()
        self.address = f"http://{HOST}:{port}/?token={token}"
        config = uvicorn.Config(
            application(setup, self._stream, token, port),
            log_level="critical",
            lifespan="off",
            timeout_graceful_shutdown=1,
            ws="auto",
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._serve, name="cdia-view", daemon=True)
        self._thread.start()
        self._wait_for_start()

    def show(self, frame: Frame) -> None:
        """Add one frame, or several, to what the page shows.

        Args:
            frame: The rows to append.

        Raises:
            CdiaError: If the server has ended.
        """
        self._send(frame)

    def say(self, sentence: str) -> None:
        """Show a sentence above the arm.

        Args:
            sentence: Its text; an empty one removes it.

        Raises:
            CdiaError: If the server has ended.
        """
        self._send({"say": sentence})

    def finish(self) -> None:
        """Tell the page that no more frames will come.

        Raises:
            CdiaError: If the server has ended.
        """
        self._send({"finished": True})

    def wait(self) -> None:
        """Serve until the process is interrupted or the server ends."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def close(self) -> None:
        """Stop serving; a second time does nothing."""
        self._server.should_exit = True
        self._thread.join(LAST)
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, message: Mapping[str, object]) -> None:
        try:
            if not self._thread.is_alive():
                raise RuntimeError
            self._stream.add(message)
        except RuntimeError:  # its loop is closed
            raise CdiaError(f"the live view at {self.address} is gone: its server has ended") from None

    def _serve(self) -> None:
        self._server.run(sockets=[self._socket])

    def _wait_for_start(self) -> None:
        until = time.monotonic() + PATIENCE
        while not self._server.started:
            if not self._thread.is_alive() or time.monotonic() > until:
                self.close()
                raise CdiaError(f"the live view does not begin to serve at {self.address}")
            time.sleep(0.01)


def _bound(port: int) -> socket.socket:
    """Return a socket on this machine's own address, so that no other machine can reach it."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((HOST, port))
    except (OSError, OverflowError) as error:
        found.close()
        reason = getattr(error, "strerror", None) or str(error)
        raise CdiaError(f"cannot serve at {HOST}:{port}: {reason}; leave out --port for a free one") from None
    return found
