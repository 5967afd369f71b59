"""The server of the app: its pages, on this machine only."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable
from importlib import import_module

from fastapi import Response
from nicegui import app, ui
from starlette.middleware.trustedhost import TrustedHostMiddleware

from cdia_pin.app.inputs import Request
from cdia_pin.app.page_files import SERVED, served
from cdia_pin.app.parts import node
from cdia_pin.errors import CdiaError

HOST = "127.0.0.1"
PORT = 8400
RECONNECT = 60.0  # [s], for which a tab that is cut off keeps its work
PAGES = {"/": "Find what is missing", "/live": "While it moves"}
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
    app.on_startup(lambda: asyncio.create_task(_announce(chosen)))
    ui.run(
        host=HOST,
        port=chosen,
        title="cdia",
        favicon=ICON,
        dark=None,
        language="en-US",
        reload=False,
        show=show,
        tailwind=False,
        show_welcome_message=False,
        reconnect_timeout=RECONNECT,
        timeout_graceful_shutdown=1,  # [s]: an open tab does not keep it
    )


async def _announce(port: int) -> None:
    """Say where the app is, once it answers, and make ready."""
    while True:
        try:
            _, writer = await asyncio.open_connection(HOST, port)
        except OSError:
            await asyncio.sleep(0.02)
            continue
        writer.close()
        print(f"cdia app: http://{HOST}:{port}  (Ctrl-C ends it)", flush=True)
        for page in ("find_page", "live_page"):  # so that the first tab need not wait for it
            await asyncio.to_thread(import_module, f"cdia_pin.app.{page}")
        return


def build(start: Request | None) -> None:
    """Declare pages and files."""
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
    """Return the port asked for, or the usual one if it is free, or any that is; raises CdiaError if it is taken."""
    for port in [asked] if asked is not None else [PORT, 0]:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((HOST, port))
            except (OSError, OverflowError):
                continue
            return int(probe.getsockname()[1])
    raise CdiaError(f"port {asked} of {HOST} cannot be used: give another with --port")
