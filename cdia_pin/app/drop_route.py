"""The address to which a page sends dropped files."""

from __future__ import annotations

from contextlib import suppress

from fastapi import Request, Response
from fastapi.responses import PlainTextResponse
from nicegui import app

from cdia_pin.app.dropped import LARGEST
from cdia_pin.app.shelf import Shelf
from cdia_pin.app.visit import Visit
from cdia_pin.errors import CdiaError
from cdia_pin.whole_files import whole_file

ADDRESS = "/cdia/drop/"  # and the key of a session


def serve_drops(shelf: Shelf[Visit]) -> None:
    """Take files at an address for each session.

    Args:
        shelf: The sessions.
    """

    @app.post(ADDRESS + "{key}")
    async def receive(key: str, drop: str, path: str, request: Request) -> Response:
        visit = shelf.find(key)
        if visit is None:
            return PlainTextResponse("this session has ended: load the page again", 404)
        bench = visit.find
        size = 0
        try:
            file = bench.drops.place(drop, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            with whole_file(file) as out:
                async for chunk in request.stream():
                    size += len(chunk)
                    if size > LARGEST * 10**6:
                        raise CdiaError(f"it is larger than {LARGEST} MB, give its path instead")
                    bench.drops.count(drop, len(chunk))
                    out.write(chunk)
        except (CdiaError, OSError) as error:
            with suppress(CdiaError):  # of a drop without a name that can be
                bench.drops.forget(drop)
            return PlainTextResponse(f"{path} cannot be kept: {error}", 400)
        return Response(status_code=204)
