"""The server of the app: its pages, on this machine only."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import socket
import sys
import webbrowser
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from fastapi import Response
from fastapi.responses import RedirectResponse
from nicegui import app, background_tasks, ui
from starlette.middleware.trustedhost import TrustedHostMiddleware

from cdia_pin.app.drop_route import serve_drops
from cdia_pin.app.inputs import Request
from cdia_pin.app.page_files import SERVED, served
from cdia_pin.app.parts import node
from cdia_pin.app.scratch import Scratch
from cdia_pin.app.shelf import KEPT, Shelf
from cdia_pin.app.visit import Visit
from cdia_pin.errors import CdiaError
from cdia_pin.fault_report import fault_sentence
from cdia_pin.viewers.door import Door, entrance, new_token

if TYPE_CHECKING:
    from cdia_pin.app.runner import Runner
    from cdia_pin.app.workbench import Workbench

HOST = "127.0.0.1"
PORT = 8400
RECONNECT = 60.0  # [s], for which a tab that has lost its connection is as it was; then it is built anew
ENDED = (
    f"The session of this address has ended, {KEPT / 60:.0f} minutes after its last page: here is a new one."
)
# NiceGUI's pages hold scripts, and compile their templates in the browser.
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self'; object-src 'none'; "
    "frame-ancestors 'none'; base-uri 'self'; form-action 'self'"
)
PAGES = {"/": "Find missing effects", "/live": "While it moves"}
ICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="7" fill="#0072b2"/>'
    '<path d="M8 25V15l8-6 7 5" fill="none" stroke="#fff" stroke-width="3.2" stroke-linejoin="round"/>'
    '<circle cx="8" cy="15" r="2.6" fill="#fff"/><circle cx="16" cy="9" r="2.6" fill="#d55e00"/></svg>'
)


def serve(start: Request | None = None, *, port: int | None = None, show: bool = True) -> None:
    """Serve the app until it is interrupted.

    Args:
        start: What every new session loads at once; None for an empty form.
        port: Port on 127.0.0.1; the usual one, or else any that is free, if None.
        show: Whether to open a browser.

    Raises:
        CdiaError: If the port is taken.
    """
    chosen = free_port(port)
    scratch = Scratch()
    shelf = Shelf(lambda: Visit(lambda: _workbench(scratch, start)))
    build(shelf)
    token = new_token()
    app.add_middleware(Door, token=token, name=f"cdia-{chosen}", policy=POLICY)
    address = f"http://{HOST}:{chosen}/?token={token}"
    app.on_startup(lambda: asyncio.create_task(_announce(chosen, address, scratch.path if show else None)))
    app.on_shutdown(shelf.close)
    app.on_shutdown(scratch.close)
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


def _workbench(scratch: Scratch, start: Request | None) -> Workbench:
    """Return a new session, which loads at once what the app was started with."""
    from cdia_pin.app.workbench import Workbench

    bench = Workbench(scratch.folder())
    if start is not None:
        background_tasks.create(bench.load(start), name="first load")
    return bench


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


def build(shelf: Shelf[Visit]) -> None:
    """Declare pages and files.

    Args:
        shelf: The sessions.
    """
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])
    for name in SERVED:
        app.get(f"/cdia/{name}")(_sender(name))
    serve_drops(shelf)
    app.on_page_exception(_failed)

    @ui.page("/")
    def find(session: str = "") -> Response | None:
        visit = shelf.find(session)
        if visit is None:
            return _anew("/", shelf, lambda begun: begun.find.runner if session else None)
        _frame("/", session)
        from cdia_pin.app.find_page import FindPage

        FindPage(visit.find, session, shelf.show(session))
        return None

    @ui.page("/live")
    def live(session: str = "") -> Response | None:
        visit = shelf.find(session)
        if visit is None:
            return _anew("/live", shelf, lambda begun: begun.live.runner if session else None)
        _frame("/live", session)
        from cdia_pin.app.live_page import LivePage

        LivePage(visit.live, shelf.show(session))
        return None


def _anew(here: str, shelf: Shelf[Visit], informed: Callable[[Visit], Runner | None]) -> Response:
    """Lead to a new session, and say so to whoever came for one that has ended."""
    key = shelf.begin()
    begun = shelf.find(key)
    runner = None if begun is None else informed(begun)
    if runner is not None:
        runner.say(ENDED)
    return RedirectResponse(f"{here}?{urlencode({'session': key})}", status_code=303)


def _failed(error: Exception) -> None:
    """Show that a page could not be built, and a way on."""
    with node("div", classes="page"), node("div", classes="steps"):
        node("p", f"{fault_sentence(error, 'cdia app: a page')}.", "wrong", role="alert")
        node("a", "Begin anew", href="/")


def _sender(name: str) -> Callable[[], Response]:
    def send() -> Response:
        kind, text = served(name)
        return Response(text, media_type=kind, headers={"Cache-Control": "no-cache"})

    return send


def _frame(here: str, session: str) -> None:
    """Put head and navigation on a page; its links keep the session."""
    ui.add_head_html('<link rel="stylesheet" href="/cdia/style.css"><script src="/cdia/load.js"></script>')
    with node("header", classes="top"):
        node("b", "cdia", "brand")
        with node("nav", aria_label="Pages"):
            for path, title in PAGES.items():
                link = node("a", title, href=f"{path}?{urlencode({'session': session})}" if session else path)
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
