"""The server of the app: its pages, on this machine only."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import socket
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import FrameType

from fastapi import Response
from nicegui import app, ui
from starlette.middleware.trustedhost import TrustedHostMiddleware

from cdia_pin.app.door import Door, entrance, new_token
from cdia_pin.app.inputs import Request
from cdia_pin.app.page_files import SERVED, served
from cdia_pin.app.parts import node
from cdia_pin.errors import CdiaError

HOST = "127.0.0.1"
PORT = 8400
RECONNECT = 60.0  # [s], for which a disconnected tab keeps its session
PAGES = {"/": "Find missing effects", "/live": "While it moves"}
ICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="#0072b2"/>'
    '<path d="M8 25V15l8-6 7 5" fill="none" stroke="#fff" stroke-width="3.2" stroke-linejoin="round"/>'
    '<circle cx="8" cy="15" r="2.6" fill="#fff"/><circle cx="16" cy="9" r="2.6" fill="#d55e00"/></svg>'
)


def serve(start: Request | None = None, *, port: int | None = None, show: bool = True) -> None:
    """Serve the app until it is interrupted.

    Args:
        start: What every new tab loads at once; None for an empty form.
        port: Port on 127.0.0.1; the usual one, or else any that is free, if None.
        show: Whether to open a browser.

    Raises:
        CdiaError: If the port is taken.
    """
    chosen = free_port(port)
    build(start)
    token = new_token()
    app.add_middleware(Door, token=token, name=f"cdia-{chosen}")
    address = f"http://{HOST}:{chosen}/?token={token}"
    folder = tempfile.TemporaryDirectory(prefix="cdia-app-")
    app.on_startup(
        lambda: asyncio.create_task(_announce(chosen, address, Path(folder.name) if show else None))
    )
    app.on_shutdown(folder.cleanup)
    _end_in_order()
    ui.run(
        host=HOST,
        port=chosen,
        title="cdia",
        favicon=ICON,
        dark=None,
        language="en-US",
        reload=False,
        show=False,
        tailwind=False,
        show_welcome_message=False,
        reconnect_timeout=RECONNECT,
        timeout_graceful_shutdown=1,  # [s]: an open tab does not delay the end
    )


def _end_in_order() -> None:
    """Let SIGTERM, and a terminal that is closed, end the process as Ctrl-C does: temporary folders are removed."""

    def leave(number: int, frame: FrameType | None) -> None:  # called again by the server when it has ended
        sys.exit(128 + signal.SIGTERM)

    with contextlib.suppress(AttributeError, ValueError):  # no such signal, or not the main thread
        signal.signal(signal.SIGTERM, leave)
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))


async def _announce(port: int, address: str, opened_in: Path | None) -> None:
    """Print the address once the app answers, open it in a browser, and import the pages."""
    while True:
        try:
            _, writer = await asyncio.open_connection(HOST, port)
        except OSError:
            await asyncio.sleep(0.02)
            continue
        writer.close()
        print(f"cdia app: {address}  (Ctrl-C ends it)", flush=True)
        if opened_in is not None:
            await asyncio.to_thread(webbrowser.open, entrance(address, opened_in).as_uri())
        for page in ("find_page", "live_page"):  # the first tab need not wait for the import
            await asyncio.to_thread(import_module, f"cdia_pin.app.{page}")
        return


def build(start: Request | None) -> None:
    """Declare pages and files.

    Args:
        start: What every new tab loads at once; None for an empty form.
    """
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])
    for name in SERVED:
        app.get(f"/cdia/{name}")(_sender(name))

    @ui.page("/")
    def find() -> None:
        _frame("/")
        from cdia_pin.app.find_page import FindPage

        FindPage(start)

    @ui.page("/live")
    def live() -> None:
        _frame("/live")
        from cdia_pin.app.live_page import LivePage

        LivePage()


def _sender(name: str) -> Callable[[], Response]:
    def send() -> Response:
        kind, text = served(name)
        return Response(text, media_type=kind, headers={"Cache-Control": "no-cache"})

    return send


def _frame(here: str) -> None:
    """Put head and navigation on a page."""
    ui.add_head_html('<link rel="stylesheet" href="/cdia/style.css"><script src="/cdia/load.js"></script>')
    with node("header", classes="top"):
        node("b", "cdia", "brand")
        with node("nav", aria_label="Pages"):
            for path, title in PAGES.items():
                link = node("a", title, href=path)
                if path == here:
                    link.props["aria-current"] = "page"


def free_port(asked: int | None) -> int:
    """Return a port on 127.0.0.1.

    Args:
        asked: The port to use; None for the usual one or, if that is taken, any free one.

    Raises:
        CdiaError: If the port cannot be used.
    """
    for port in [asked] if asked is not None else [PORT, 0]:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((HOST, port))
            except (OSError, OverflowError):
                continue
            return int(probe.getsockname()[1])
    raise CdiaError(f"port {asked} of {HOST} cannot be used: give another with --port")
