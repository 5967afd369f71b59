"""The door of a server: only who has the address that was printed comes in, and only from the server's own pages.

The server listens on this machine alone, which has other users and other web pages. A secret in the first address
becomes a cookie. Each request needs the cookie; what changes something, and each socket, needs the server's own origin.
"""

from __future__ import annotations

import hmac
import os
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import cookie_parser
from starlette.responses import PlainTextResponse, RedirectResponse, Response

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

TOKEN_BYTES = 32  # of the secret: it cannot be guessed
SAFE = {"GET", "HEAD", "OPTIONS"}  # methods that change nothing
HEADERS = {
    "x-frame-options": "DENY",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
}
REFUSED = "Open the address that the command printed; it holds the key to this page.\n"


def new_token() -> str:
    """Return a secret for one run of a server."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def entrance(address: str, folder: Path) -> Path:
    """Write a page that leads to an address, readable by this user alone.

    A browser is started with a file's name: other users see the command line of every process.

    Args:
        address: With the secret.
        folder: Where to write.

    Returns:
        The file.
    """
    file = folder / "open.html"
    handle = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(handle, "w", encoding="utf-8") as page:
        page.write(
            f'<!doctype html><meta http-equiv="refresh" content="0; url={address}"><a href="{address}">cdia</a>'
        )
    return file


class Door:
    """Middleware that lets in who has the secret.

    Args:
        app: What is behind the door.
        token: The secret.
        name: Of the cookie.
        policy: What pages may load, as the header Content-Security-Policy.
    """

    def __init__(self, app: App, *, token: str, name: str, policy: str) -> None:
        self._app, self._token, self._name = app, token, name
        self._headers = {**HEADERS, "content-security-policy": policy}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or pass it on."""
        if scope["type"] == "http":
            answer = self._answer(scope)
            await (answer or self._app)(scope, receive, self._with_headers(send))
        elif scope["type"] == "websocket":
            headers = Headers(scope=scope)
            if self._has_cookie(headers) and _is_own(headers):
                await self._app(scope, receive, send)
            else:
                await receive()
                await send({"type": "websocket.close", "code": 1008})
        else:
            await self._app(scope, receive, send)

    def _answer(self, scope: Scope) -> Response | None:
        """Return what a request gets instead of the app; None where it may pass."""
        headers = Headers(scope=scope)
        query = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        given = dict(query).get("token")
        if given is not None and scope["method"] in SAFE and self._is_token(given):
            rest = urlencode([(key, value) for key, value in query if key != "token"])
            answer = RedirectResponse(scope["path"] + (f"?{rest}" if rest else ""), status_code=303)
            answer.set_cookie(self._name, self._token, httponly=True, samesite="lax", path="/")
            return answer
        if not self._has_cookie(headers):
            return PlainTextResponse(REFUSED, 403)
        if scope["method"] not in SAFE and not _is_own(headers):
            return PlainTextResponse("this page came from elsewhere\n", 403)
        return None

    def _has_cookie(self, headers: Headers) -> bool:
        return self._is_token(cookie_parser(headers.get("cookie", "")).get(self._name, ""))

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self._token.encode())

    def _with_headers(self, send: Send) -> Send:
        async def sending(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in self._headers.items():
                    headers[name] = value
            await send(message)

        return sending


def _is_own(headers: Headers) -> bool:
    """Tell whether a request comes from the server's own page: browsers state from where, pages cannot change it."""
    return headers.get("origin") == f"http://{headers.get('host')}"
