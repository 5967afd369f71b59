"""``cdia view`` in a browser: frames come while they are computed, to this machine alone, and an end is an end."""

import os
import re
import signal
import socket
import subprocess
import time
import urllib.error
import urllib.request
from http.cookiejar import CookieJar
from urllib.parse import urlsplit

import pytest

from cdia_pin import CdiaError, load_robot
from cdia_pin.viewers.live import LiveView
from cdia_pin.viewers.scene import Scene, monitor_stages
from tests.processes import python

FAULT = "viscous_friction@joint2: coefficient=0.3, after=2"
SIMULATION = (
    "--simulate",
    "--robot",
    "double_pendulum",
    "--fault",
    FAULT,
    "--duration",
    "12",
    "--bank",
    "coulomb_friction",
    "--bank",
    "viscous_friction",
    "--rate",
    "250",
)


class Command:
    """``cdia view`` as a process, with the address that it printed."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen(
            python("-m", "cdia_pin", "view", *map(str, arguments), "--no-open"),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        for line in self.process.stdout:
            if found := re.search(r"http://\S+", line):
                self.address = found[0]
                return
        raise AssertionError(self.process.stderr.read())

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


@pytest.fixture
def command():
    started = []

    def start(*arguments):
        started.append(Command(*arguments))
        return started[-1]

    yield start
    for one in started:
        one.end()


def settled(page, ask, wanted, seconds=240.0):
    """Ask the page until it answers what is wanted."""
    until = time.monotonic() + seconds
    while not wanted(answer := page.evaluate(ask)):
        assert time.monotonic() < until, f"{ask}: still {answer}; {page.seen.errors}"
        page.wait_for_timeout(100)
    return answer


def test_a_simulation_is_seen_while_it_runs(page, command, screenshots):
    running = command(*SIMULATION)
    page.goto(running.address)
    settled(page, "() => globalThis.player ? player.end : 0", lambda end: end > 0.5)
    first = page.evaluate("() => [player.time, player.applied]")
    settled(page, "() => player.time", lambda t: t > first[0] + 0.5)
    assert page.evaluate("() => player.applied") > first[1]
    assert page.evaluate("() => arm.state().ghost")
    found = "() => { const s = arm.state(); return [s.label, s.joints.joint2.stage]; }"
    label, stage = settled(page, found, lambda x: x[1] in ("isolated", "accommodated"))
    assert "viscous friction on joint2" in label
    assert stage == "accommodated"
    page.screenshot(path=screenshots / "view.png")
    hosts = {urlsplit(url).netloc for url in page.seen.requests}
    assert hosts == {urlsplit(running.address).netloc}
    assert page.seen.errors == []

    running.process.send_signal(signal.SIGKILL)
    said = "() => document.getElementById('lost').hidden ? '' : document.getElementById('lost').textContent"
    assert "Connection lost" in settled(page, said, bool, 5.0)
    page.evaluate("() => { player.pause(); player.seek(1.0); }")  # what has come can still be played
    assert page.evaluate("() => arm.state().joints.joint2.stage") in ("healthy", "suspect")


def test_a_watched_simulation_names_but_does_not_correct(page, command):
    running = command(*SIMULATION, "--no-accommodate", "--speed", 0)
    page.goto(running.address)
    ended = "() => globalThis.player && !player.live"
    settled(page, ended, bool)
    page.evaluate("() => player.seek(player.end)")
    assert page.evaluate("() => arm.state().joints.joint2.stage") == "isolated"


def test_a_log_is_coloured_by_what_the_model_misses(page, command, tmp_path):
    from cdia_pin import write_log
    from tests.cli.conftest import HIDDEN, pendulum_log

    write_log(pendulum_log(1, HIDDEN), tmp_path / "run.csv")
    running = command(tmp_path / "run.csv", "--robot", "double_pendulum", "--no-check")
    page.goto(running.address)
    settled(page, "() => globalThis.player ? player.end : 0", bool)
    page.evaluate("() => { player.pause(); player.seek(8); }")
    state = page.evaluate("() => arm.state()")
    assert state["joints"]["joint2"]["intensity"] > state["joints"]["joint1"]["intensity"]
    assert "joint2" in state["label"]
    assert "model error" in page.inner_text(".arm3d-legend")
    assert page.seen.errors == []


@pytest.mark.parametrize("healthy", ["--monitor", "--healthy"])
def test_a_log_is_coloured_by_the_stages_of_a_monitor(page, command, tmp_path, healthy):
    from cdia_pin import Dynamics, write_log
    from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
    from cdia_pin.effects import parse_term

    settings = LoopSettings(rate=250.0, healthy_duration=10.0, seed=4)
    loop = ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)
    fault = parse_term("viscous_friction@joint2: coefficient=0.2, after=8")
    write_log(loop.run(loop.motion(0, 12.0), [fault]).log, tmp_path / "run.csv")
    given = [healthy]
    if healthy == "--healthy":
        write_log(loop.run(loop.motion(9, 10.0)).log, tmp_path / "before.csv")
        given.append(tmp_path / "before.csv")
    running = command(
        tmp_path / "run.csv", "--robot", "double_pendulum", "--no-check", "--bank", "viscous_friction", *given
    )
    page.goto(running.address)
    settled(page, "() => Boolean(globalThis.player && !player.live)", bool)
    begin = page.evaluate("() => player.begin")
    assert begin < 0.1 if healthy == "--healthy" else begin > 4.0
    page.evaluate("() => { player.pause(); player.seek(7.9); }")
    assert page.evaluate("() => arm.state().joints.joint2.stage") in ("healthy", "suspect")
    page.evaluate("() => player.seek(player.end)")
    state = page.evaluate("() => arm.state()")
    assert state["joints"]["joint2"]["stage"] in ("isolated", "accommodated")
    assert "viscous friction" in state["label"]


def test_thirty_updates_a_second_keep_up(page):
    robot = load_robot("scara")
    with LiveView(Scene.of(robot), stages=monitor_stages()) as view:
        page.goto(view.address)
        settled(page, "() => Boolean(globalThis.player)", bool)
        page.wait_for_timeout(1000)
        begin = time.monotonic()
        for k in range(120):
            stage = [k // 10 % 6] * robot.n
            frame = {"time": [k / 30], "position": [[0.001 * k] * robot.n], "stage": [stage]}
            view.show({**frame, "level": [[1.0] * robot.n], "torque": [[0.0] * robot.n]})
            page.wait_for_timeout(max(0.0, 1e3 * (begin + (k + 1) / 30 - time.monotonic())))
        settled(page, "() => player._data.time.length", lambda n: n == 120, 5.0)
        settled(page, "() => player.end - player.time", lambda behind: behind < 0.3, 5.0)
        # Without drawing between them: what an update itself costs.
        cost = page.evaluate(
            """() => { const t = performance.now(); for (let k = 0; k < 300; k++) player.seek(k / 100);
            return (performance.now() - t) / 300; }"""
        )
        assert cost < 1000 / 30


@pytest.fixture
def served():
    with LiveView(Scene.of(load_robot("scara"))) as view:
        yield view


def place(address):
    """Where a view is served, without its key."""
    return address.partition("?")[0]


def visitor(address):
    """A browser that has come in by the address, and its cookie."""
    cookies = CookieJar()
    browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(cookies))
    assert ask(address, browser) == 200
    return browser, "; ".join(f"{c.name}={c.value}" for c in cookies)


def ask(address, browser=None, **headers):
    """Status of a request."""
    browser = browser or urllib.request.build_opener()
    try:
        with browser.open(urllib.request.Request(address, headers=headers), timeout=5) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_only_this_machine_is_served(served):
    port = urlsplit(served.address).port
    assert served._socket.getsockname()[0] == "127.0.0.1"
    browser, _ = visitor(served.address)
    assert ask(place(served.address) + "nothing", browser) == 404
    assert ask(served.address, Host=f"evil.example:{port}") == 400
    assert ask(place(served.address)) == ask(place(served.address) + "setup.json") == 403  # without the key
    others = {a[4][0] for a in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    for other in others:
        with pytest.raises(OSError), socket.create_connection((other, port), timeout=1):
            pass


@pytest.mark.parametrize("origin", ["http://evil.example", "null", None])
def test_another_origin_gets_no_stream(served, origin):
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    _, cookie = visitor(served.address)
    address = place(served.address).replace("http", "ws") + "stream"
    headers = {"Cookie": cookie}
    with (
        pytest.raises(InvalidStatus),
        connect(address, origin=origin, additional_headers=headers, proxy=None),
    ):
        pass


def test_our_own_origin_without_the_key_gets_no_stream(served):
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    address, origin = place(served.address), place(served.address).rstrip("/")
    with (
        pytest.raises(InvalidStatus),
        connect(address.replace("http", "ws") + "stream", origin=origin, proxy=None),
    ):
        pass


def test_our_own_origin_gets_every_frame(served):
    from websockets.sync.client import connect

    served.show({"time": [0.0], "position": [[0.0] * 4]})
    _, cookie = visitor(served.address)
    address, origin = place(served.address), place(served.address).rstrip("/")
    where, headers = address.replace("http", "ws") + "stream", {"Cookie": cookie}
    with connect(where, origin=origin, additional_headers=headers, proxy=None) as stream:
        assert '"time":[0.0]' in stream.recv(timeout=2)
        served.say("hello")
        assert "hello" in stream.recv(timeout=2)


def test_a_dead_server_is_an_error_within_two_seconds():
    view = LiveView(Scene.of(load_robot("scara")))
    view._server.should_exit = True  # as if it had died
    view._thread.join(5)
    begin = time.monotonic()
    with pytest.raises(CdiaError, match="is gone"):
        view.show({"time": [0.0], "position": [[0.0] * 4]})
    view.close()
    assert time.monotonic() - begin < 2


def test_a_port_in_use_is_an_error(served):
    port = urlsplit(served.address).port
    with pytest.raises(CdiaError, match=f"cannot serve at 127.0.0.1:{port}"):
        LiveView(Scene.of(load_robot("scara")), port=port)


def test_a_killed_command_leaves_nothing_behind(command):
    running = command(*SIMULATION)
    assert children(running.process.pid) == []
    running.process.kill()
    running.process.wait(5)
    with pytest.raises(OSError):
        urllib.request.urlopen(running.address, timeout=2)


def test_control_c_ends_it(command):
    running = command(*SIMULATION)
    time.sleep(0.5)
    running.process.send_signal(signal.SIGINT)
    assert running.process.wait(60) == 0
    assert "Traceback" not in running.process.stderr.read()


def children(pid):
    """Processes that a process has started."""
    folder = f"/proc/{pid}/task/{pid}/children"
    if not os.path.exists(folder):  # noqa: PTH110
        pytest.skip("no /proc to ask")
    with open(folder, encoding="ascii") as file:  # noqa: PTH123
        return file.read().split()
