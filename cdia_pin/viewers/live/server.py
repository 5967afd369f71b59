"""The server of the live view: one page, its files and a stream of frames, for who has its address."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

from cdia_pin.viewers.page import asset
from cdia_pin.viewers.scene.assets import scene_assets

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.websockets import WebSocket

NAMES = ("127.0.0.1", "localhost")
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; img-src data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


class Stream:
    """Messages in their order; every browser gets all of them, from the first.

    Any thread adds messages; the thread of the server sends them.
    """

    def __init__(self) -> None:
        self._messages: list[str] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._news: asyncio.Event = asyncio.Event()

    def add(self, message: Mapping[str, object]) -> None:
        """Add a message.

        Args:
            message: As JSON has it.

        Raises:
            RuntimeError: If the server has ended.
        """
        self._messages.append(json.dumps(message, separators=(",", ":"), allow_nan=False))
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._wake)

    def _wake(self) -> None:
        self._news.set()
        self._news = asyncio.Event()

    async def send(self, socket: WebSocket) -> None:
        """Send all messages, and those to come.

        Args:
            socket: Of one browser.
        """
        self._loop = asyncio.get_running_loop()
        sent = 0
        while True:
            news = self._news
            for message in self._messages[sent:]:
                await socket.send_text(message)
                sent += 1
            if sent == len(self._messages):
                await news.wait()


def application(setup: Mapping[str, object], stream: Stream, token: str, port: int) -> Starlette:
    """Return the application.

    Args:
        setup: ``scene`` and ``timeline``, with which the page begins.
        stream: What follows.
        token: The secret of its address.
        port: Of its address.
    """
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.middleware.trustedhost import TrustedHostMiddleware
    from starlette.responses import PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocketDisconnect

    from cdia_pin.viewers.door import Door

    assets = scene_assets()
    script = "text/javascript"
    parts = {
        "/": (asset("live.html"), "text/html"),
        "/meshcat.js": (assets.meshcat, script),
        "/arm3d.js": (assets.script, script),
        "/live.js": (asset("live.js"), script),
        "/arm3d.css": (assets.style, "text/css"),
        "/live.css": (asset("live.css"), "text/css"),
        "/setup.json": (json.dumps(setup, separators=(",", ":"), allow_nan=False), "application/json"),
    }

    async def part(request: Request) -> Response:
        text, kind = parts[request.url.path]
        return Response(text, media_type=kind, headers={"Cache-Control": "no-store"})

    async def follow(socket: WebSocket) -> None:
        await socket.accept()
        sending = asyncio.create_task(stream.send(socket))
        with contextlib.suppress(WebSocketDisconnect):
            while True:
                await socket.receive_text()
        sending.cancel()

    return Starlette(
        routes=[*(Route(path, part) for path in parts), WebSocketRoute("/stream", follow)],
        # A foreign name that resolves to this machine must not read anything either.
        middleware=[
            Middleware(TrustedHostMiddleware, allowed_hosts=list(NAMES), www_redirect=False),
            Middleware(Door, token=token, name=f"cdia-view-{port}", policy=POLICY),
        ],
        exception_handlers={404: lambda request, error: PlainTextResponse("no such page", 404)},
    )
