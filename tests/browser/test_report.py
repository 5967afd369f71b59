"""Reports as people use them: from disk, without network, the arm tied to the charts."""

from __future__ import annotations

import re
import time as clock
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdia_pin import Dynamics, RobotModel, compare, discover, exciting_trajectory, load_robot, simulate
from cdia_pin.diagnosis import Monitor, replay
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
from cdia_pin.selection import DiscoverySettings
from cdia_pin.viewers import write_monitor_report, write_report
from cdia_pin.viewers.page import LARGEST

RATE = 250.0  # [Hz]
FAULTY, ONSET = "panda_joint4", 30.0
EFFECTS = ("coulomb_friction", "torque_offset")
STATE = "() => ({...motion.arm.state(), time: motion.player.time})"
CURSOR = """() => Array.from(document.querySelectorAll('#motion .u-over'), (o) => {
  const x = o.querySelector('.u-cursor-x').style.transform.match(/translate\\((-?[0-9.]+)px/);
  return x ? Number(x[1]) / o.clientWidth : null;
})"""


@dataclass(frozen=True)
class Written:
    """A report on disk, and what it was made from."""

    path: Path
    log: Log
    robot: RobotModel
    begin: float  # [s], of the time axis of the charts
    end: float


def measured(robot: RobotModel, seed: int, duration: float, *faults: str) -> Log:
    """What a simulated arm reads, each torque held until the next sample as a monitor expects it."""
    plant = Dynamics(robot, tuple(parse_term(f) for f in faults))
    motion_of, noise = np.random.default_rng(seed).spawn(2)
    motion = exciting_trajectory(robot, motion_of, duration=duration)
    return simulate(plant, motion, rate=RATE, sensors=Sensors(effort_share=0.01), rng=noise)


def exact(robot: RobotModel, seed: int, duration: float, *faults: str) -> Log:
    """What an arm reads that follows its motion exactly, which takes no simulation."""
    plant = Dynamics(robot, tuple(parse_term(f) for f in faults))
    motion_of, noise = np.random.default_rng(seed).spawn(2)
    time = np.arange(0.0, duration, 1.0 / RATE)
    q, v, a = exciting_trajectory(robot, motion_of, duration=duration)(time)
    tau = plant.inverse_dynamics(q, v, a)
    tau += 0.01 * tau.std(axis=0) * noise.standard_normal(tau.shape)
    return Log(robot.joints, time, q, tau, velocity=v)


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """A minute of a Panda whose fourth drive loses a third of its torque half way."""
    robot = load_robot("panda")
    fault = parse_term(f"actuator_gain@{FAULTY}: gain=-0.3, after={ONSET}")
    log = measured(robot, 1, 60.0, f"actuator_gain@{FAULTY}: gain=-0.3, after={ONSET}")
    run = replay(Monitor(Dynamics(robot), healthy=[measured(robot, 2, 20.0)]), log)
    path = write_monitor_report(tmp_path_factory.mktemp("run") / "watch.html", run, present=[fault])
    return Written(path, log, robot, float(run.time[0]), float(run.time[-1]))


@pytest.fixture(scope="module")
def discovered(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """A minute of a Panda with friction and an offset that its model lacks."""
    robot = load_robot("panda")
    log = exact(
        robot, 3, 60.0, f"coulomb_friction@{FAULTY}: level=4", "torque_offset@panda_joint6: offset=0.5"
    )
    found = discover(Dynamics(robot), log, settings=DiscoverySettings(effects=EFFECTS))
    before = compare(Dynamics(robot), log)
    path = tmp_path_factory.mktemp("found") / "report.html"
    write_report(path, before, improved=compare(found.model, log), discovery=found)
    return Written(path, log, robot, float(before.time[0]), float(before.time[-1]))


@pytest.fixture(params=["watched", "discovered"])
def written(request: pytest.FixtureRequest) -> Written:
    return request.getfixturevalue(request.param)


def until(page: Any, expression: str, patience: float = 15.0) -> None:
    """Wait until an expression holds; Playwright's own way needs eval, which the page forbids."""
    end = clock.monotonic() + patience
    while not page.evaluate(expression):
        assert clock.monotonic() < end, f"not within {patience:g} s: {expression}"
        page.wait_for_timeout(50)


def opened(page: Any, written: Written) -> Any:
    page.goto(written.path.as_uri())
    until(page, "Boolean(motion.arm && motion.arm.frames > 0)")
    return page


def hover(page: Any, written: Written, share: float, chart: int = 0) -> float:
    """Move the pointer over a chart beside the arm; returns the time there [s]."""
    over = page.locator("#motion .u-over").nth(chart)
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 0.5 * box["height"])
    page.mouse.move(box["x"] + share * box["width"], box["y"] + 0.5 * box["height"])
    moment = written.begin + share * (written.end - written.begin)
    until(page, f"Math.abs(motion.player.time - {moment}) < 0.5")
    return page.evaluate("motion.player.time")


def apart(placements: np.ndarray) -> np.ndarray:
    """Return how far joints are from each other [m], which no frame of a drawing changes, shape (n, n)."""
    at = placements[:, :3, 3]
    return np.linalg.norm(at[:, None] - at[None], axis=-1)


# ------------------------------------------------------------------ one file


def test_a_minute_of_a_panda_fits_in_six_megabytes(written: Written):
    assert LARGEST == 6_000_000
    assert written.path.stat().st_size <= LARGEST


def test_it_opens_from_disk_without_any_request(page: Any, written: Written):
    opened(page, written)
    page.mouse.wheel(0, 4000)
    page.wait_for_timeout(300)
    assert page.seen.requests == [written.path.as_uri()]
    assert page.seen.errors == []


def test_the_picture_is_not_empty(page: Any, written: Written):
    opened(page, written)
    lit = page.evaluate("""() => {
      motion.arm.viewer.render();
      const from = motion.arm.box.querySelector('canvas'), to = document.createElement('canvas');
      to.width = 80; to.height = 80;
      to.getContext('2d').drawImage(from, 0, 0, 80, 80);
      const pixels = to.getContext('2d').getImageData(0, 0, 80, 80).data;
      return new Set(Array.from({length: 6400}, (_, k) => pixels.slice(4 * k, 4 * k + 4).join())).size;
    }""")
    assert lit > 50


# ------------------------------------------------------------------ arm and charts


def test_hovering_a_chart_moves_the_arm(page: Any, written: Written):
    opened(page, written)
    moment = hover(page, written, 0.7)
    assert moment == pytest.approx(written.begin + 0.7 * (written.end - written.begin), abs=0.5)
    shown = page.evaluate(STATE)["joints"]
    q = np.array([np.interp(moment, written.log.time, p) for p in written.log.position.T])
    expected = written.robot.joint_placements(q)
    drawn = np.array([shown[j]["world"] for j in written.robot.joints])
    np.testing.assert_allclose(apart(drawn), apart(expected), atol=0.01)


def test_hovering_another_chart_moves_it_as_well(page: Any, written: Written):
    opened(page, written)
    first, second = hover(page, written, 0.2), hover(page, written, 0.6, chart=1)
    assert second - first == pytest.approx(0.4 * (written.end - written.begin), abs=1.0)


def test_playing_moves_the_cursor_of_every_chart(page: Any, written: Written):
    opened(page, written)
    before, started = page.evaluate(CURSOR), page.evaluate("motion.player.time")
    page.get_by_role("button", name="Play", exact=True).click()
    until(page, f"motion.player.time > {started} + 0.5")
    page.get_by_role("button", name="Pause", exact=True).click()
    after = page.evaluate(CURSOR)
    moment = page.evaluate("motion.player.time")
    assert len(after) >= 2
    assert all((b or 0.0) < a for b, a in zip(before, after, strict=True))
    share = (moment - written.begin) / (written.end - written.begin)
    assert after == pytest.approx([share] * len(after), abs=0.02)


def test_a_keyboard_is_enough(page: Any, written: Written):
    """Joints are chosen, and time is moved, with the keyboard alone."""
    opened(page, written)
    button = page.locator("#motion .picker:not(.steps) button").nth(1)
    button.focus()
    page.keyboard.press("Enter")
    name = written.robot.joints[1]
    assert button.get_attribute("aria-pressed") == "true"
    assert page.evaluate(STATE)["selected"] == name
    assert name in page.locator("#motion h3").first.inner_text()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent").startswith(written.robot.joints[2])
    page.get_by_role("slider", name="Time").focus()
    begin = page.evaluate("motion.player.time")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("motion.player.time") == pytest.approx(begin + 1.0)
    page.keyboard.press("End")
    assert page.evaluate("motion.player.time") == pytest.approx(page.evaluate("motion.player.end"))


def test_a_click_on_a_link_chooses_its_joint(page: Any, written: Written):
    opened(page, written)
    page.evaluate("motion.arm.box.scrollIntoView({block: 'center'})")
    found = page.evaluate("""() => {
      const area = motion.arm.box.querySelector('canvas').getBoundingClientRect();
      for (let y = 0.05; y < 1; y += 0.02) for (let x = 0.05; x < 1; x += 0.02) {
        const [px, py] = [area.left + x * area.width, area.top + y * area.height].map(Math.round); // as a mouse has it
        const joint = motion.arm.jointAt(px, py), on = document.elementFromPoint(px, py);
        if (joint && joint !== chosen.joint && on && on.tagName === 'CANVAS') return {x: px, y: py, joint};
      }
    }""")
    page.mouse.click(found["x"], found["y"])
    pressed = page.locator('#motion .picker:not(.steps) button[aria-pressed="true"]')
    assert pressed.inner_text().startswith(found["joint"])


# ------------------------------------------------------------------ colours


def distance(one: str, other: str) -> float:
    rgb = [[int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in (one, other)]
    return float(np.linalg.norm(np.subtract(*rgb)))


def test_the_faulty_link_takes_the_colour_of_its_stage(page: Any, watched: Written):
    opened(page, watched)
    page.evaluate(f"motion.player.seek({ONSET - 5})")
    healthy = page.evaluate(STATE)["joints"]
    page.evaluate(f"motion.player.seek({ONSET + 15})")
    faulty = page.evaluate(STATE)["joints"]
    assert healthy[FAULTY]["stage"] == "healthy"
    assert faulty[FAULTY]["stage"] == "accommodated"
    blue = "#0072b2"
    assert distance(faulty[FAULTY]["colour"], blue) < 0.5 * distance(healthy[FAULTY]["colour"], blue)
    others = [j for j in watched.robot.joints if j != FAULTY]
    assert all(distance(faulty[j]["colour"], blue) > distance(faulty[FAULTY]["colour"], blue) for j in others)
    assert page.evaluate(STATE)["arrow"] == FAULTY


def test_the_picture_clears_as_effects_are_added(page: Any, discovered: Written):
    opened(page, discovered)
    page.evaluate("motion.player.seek(20)")
    buttons = page.locator(".steps button")
    assert buttons.count() >= 3
    assert buttons.first.inner_text() == "as given"
    given = page.evaluate(STATE)["joints"][FAULTY]["intensity"]
    buttons.last.click()
    assert buttons.last.get_attribute("aria-pressed") == "true"
    left = page.evaluate(STATE)["joints"][FAULTY]["intensity"]
    assert left < 0.3 * given


def test_a_discovery_opens_with_its_error_coloured(page: Any, discovered: Written):
    opened(page, discovered)
    shown = page.evaluate(STATE)["joints"]
    assert max(j["intensity"] for j in shown.values()) > 0.5


def test_isolation_shows_which_hypotheses_live(page: Any, watched: Written):
    opened(page, watched)
    card = page.locator(".card", has=page.get_by_text(f"{FAULTY}: the hypotheses over time"))
    gain = card.locator('.strip[aria-label^="actuator gain"]')
    assert "leading" in gain.get_attribute("aria-label")
    other = card.locator('.strip[aria-label^="joint spring"]')
    assert "leading" not in other.get_attribute("aria-label")
    assert page.get_by_text(f"{FAULTY}, actuator gain: gain").count() == 1


# ------------------------------------------------------------------ other screens


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_follows_the_colours_of_the_system(page: Any, written: Written, scheme: str, screenshots: Path):
    page.emulate_media(color_scheme="light" if scheme == "dark" else "dark")
    opened(page, written)
    page.emulate_media(color_scheme=scheme)
    until(page, f"motion.arm.box.dataset.theme === '{scheme}'")
    red = page.evaluate("getComputedStyle(document.body).backgroundColor.match(/\\d+/)[0]")
    assert (int(red) < 80) == (scheme == "dark")
    page.evaluate("motion.player.seek(42)")
    page.locator("#motion").scroll_into_view_if_needed()
    page.wait_for_timeout(300)
    page.screenshot(path=screenshots / f"{written.path.stem}-{scheme}.png")
    assert page.seen.errors == []


@pytest.mark.parametrize("width", [390, 420])
def test_a_narrow_window_needs_no_scrolling_sideways(page: Any, written: Written, width: int):
    page.set_viewport_size({"width": width, "height": 800})
    opened(page, written)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    widths = page.evaluate("Array.from(document.querySelectorAll('#motion .u-over'), (o) => o.clientWidth)")
    assert all(200 < w < width for w in widths)


def test_paper_has_a_still_picture_of_the_arm(page: Any, discovered: Written):
    opened(page, discovered)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator(".arm3d-still").is_visible()
    drawn = """() => { const c = document.querySelector(".arm3d-still");
      const { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height);
      return data.filter((x, k) => k % 4 === 3 && x > 200).length; }"""
    assert page.evaluate(drawn) > 2000  # pixels of the arm
    assert not page.locator(".arm3d-bar").is_visible()
    assert page.locator("details.group:not(.tail)").evaluate_all("groups => groups.every((g) => g.open)")


HEADED = """() => {
  const seen = (e) => e.checkVisibility();
  const next = (e) => { // what follows an element, down to what begins it
    while (e && !(e.nextElementSibling && seen(e.nextElementSibling))) e = e.nextElementSibling || e.parentElement;
    let leaf = e && e.nextElementSibling;
    while (leaf && !leaf.matches('.chart, .legend, .strips, .picker, .arm, table') && [...leaf.children].some(seen))
      leaf = [...leaf.children].find(seen);
    return leaf;
  };
  // The file of a printed page says where each element is to which a link leads.
  const place = (e) => {
    e.id = e.id || 'place' + document.querySelectorAll('[id^=place]').length;
    document.body.append(Object.assign(document.createElement('a'), { href: '#' + e.id, hidden: true }));
    return e.id;
  };
  const heads = [...document.querySelectorAll('h2, h3, .lead, .legend, details[open] > summary')].filter(seen);
  return heads.map((e) => [e, next(e)]).filter(([, to]) => to && !to.closest('footer'))
    .map(([e, to]) => [place(e), place(to), e.textContent]);
}"""


@pytest.mark.parametrize(
    "paper", [{"format": "A4"}, {"format": "Letter"}, {"format": "A4", "landscape": True}]
)
def test_on_paper_no_heading_is_left_at_the_end_of_a_page(page: Any, written: Written, paper: dict[str, Any]):
    opened(page, written)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    heads = page.evaluate(HEADED)
    assert len(heads) > 20
    page.emulate_media(media="null")  # of the window, where printing begins
    on = pages_of(page.pdf(**paper))
    assert len(set(on.values())) > 2
    stranded = [words for head, headed, words in heads if on[head] != on[headed]]
    assert stranded == []


def pages_of(pdf: bytes) -> dict[str, int]:
    """Return on which page of a PDF each element stands to which a link leads; pages have numbers of their objects."""
    places = re.findall(rb"/([\w-]+) \[(\d+) 0 R /XYZ ", pdf)
    return {name.decode(): int(at) for name, at in places}


def test_paper_has_no_hints_for_a_mouse(page: Any, written: Written):
    opened(page, written)
    hints = [page.get_by_text(words) for words in ("Drag across a chart", "Hover a chart")]
    assert all(hint.first.is_visible() for hint in hints)
    page.emulate_media(media="print")
    assert not any(hint.first.is_visible() for hint in hints)
