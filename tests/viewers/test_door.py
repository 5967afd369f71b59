"""Who does not have the address that was printed gets nothing: no page, no file, no socket."""

import asyncio
import stat
from concurrent.futures import ThreadPoolExecutor

import pytest

pytest.importorskip("starlette")
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route, WebSocketRoute
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from cdia_pin.viewers.door import Door, entrance

TOKEN = "t0ken"
POLICY = "default-src 'self'; frame-ancestors 'none'"
HERE = "http://127.0.0.1:8400"
SOCKET = "ws://127.0.0.1:8400/ws"


async def page(request):
    return PlainTextResponse("secret")


async def socket(connection):
    await connection.accept()
    await connection.send_text("secret")
    await connection.close()


@pytest.fixture
def browser():
    app = Starlette(routes=[Route("/", page, methods=["GET", "POST"]), WebSocketRoute("/ws", socket)])
    return TestClient(
        Door(app, token=TOKEN, name="cdia-8400", policy=POLICY), base_url=HERE, follow_redirects=False
    )


def test_without_the_token_there_is_nothing(browser):
    for address in ("/", "/?token=wrong", "/?token=", "/anything", "/?token=%ff"):
        answer = browser.get(address)
        assert answer.status_code == 403 and "secret" not in answer.text
    browser.cookies.set("cdia-8400", "wrong")
    assert browser.get("/").status_code == 403


def test_the_address_opens_the_door_and_the_token_leaves_the_address(browser):
    first = browser.get(f"/?token={TOKEN}&x=1")
    assert first.status_code == 303 and first.headers["location"] == "/?x=1"
    cookie = first.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=lax" in cookie and "Path=/" in cookie
    assert browser.get("/").text == "secret"


def test_every_answer_forbids_frames_and_foreign_scripts(browser):
    for answer in (browser.get("/"), browser.get(f"/?token={TOKEN}"), browser.get("/")):
        assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
        assert "default-src 'self'" in answer.headers["content-security-policy"]
        assert answer.headers["x-frame-options"] == "DENY"
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "no-referrer"


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:9999", "https://127.0.0.1:8400"]
)
def test_another_origin_posts_nothing_and_opens_no_socket(browser, origin):
    browser.get(f"/?token={TOKEN}")
    assert browser.post("/", headers={"origin": origin}).status_code == 403
    with pytest.raises(WebSocketDisconnect), browser.websocket_connect(SOCKET, headers={"origin": origin}):
        pass
    assert browser.post("/", headers={"origin": HERE}).status_code == 200


def test_a_socket_needs_cookie_and_origin(browser):
    with pytest.raises(WebSocketDisconnect), browser.websocket_connect(SOCKET, headers={"origin": HERE}):
        pass
    browser.get(f"/?token={TOKEN}")
    with pytest.raises(WebSocketDisconnect), browser.websocket_connect(SOCKET):
        pass
    with browser.websocket_connect(SOCKET, headers={"origin": HERE}) as connection:
        assert connection.receive_text() == "secret"


def test_the_lifespan_passes():
    seen = []

    async def inner(scope, receive, send):
        seen.append(scope["type"])

    door = Door(inner, token=TOKEN, name="x", policy=POLICY)
    with ThreadPoolExecutor(1) as apart:  # a browser's tests may have left a loop in this thread
        apart.submit(lambda: asyncio.run(door({"type": "lifespan"}, None, None))).result()
    assert seen == ["lifespan"]


def test_no_other_user_reads_the_token_from_a_command_line(tmp_path):
    file = entrance(f"{HERE}/?token={TOKEN}", tmp_path)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert TOKEN in file.read_text() and TOKEN not in file.as_uri()
