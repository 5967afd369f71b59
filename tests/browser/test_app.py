"""The app as people use it: from a log to what is missing, in a real browser."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, exciting_trajectory, load_model, load_robot, write_log
from cdia_pin.effects import parse_term
from cdia_pin.resources import logs_dir
from tests.browser.served_app import PATIENCE, Served, error, mark, quiet

DEMO = logs_dir() / "demo_ur5.csv"  # hidden: a payload, and Coulomb friction of the elbow
COULOMB = "coulomb_friction@elbow_joint"


@pytest.fixture(scope="module")
def app() -> Iterator[Served]:
    served = Served()
    yield served
    served.interrupt()
    assert "Traceback" not in "".join(served.said), "".join(served.said)


@pytest.fixture
def tab(page: Any, app: Served) -> Iterator[Any]:
    """A tab of the app; at its end nothing may be wrong with it."""
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    page.wait_for_selector("[data-mark=load]")
    yield page
    quiet(page, app)


def load_demo(page: Any) -> None:
    mark(page, "demo").click()
    mark(page, "loaded").wait_for()


def read_percent(text: str) -> float:
    return float(text.replace("\N{NO-BREAK SPACE}%", "").strip()) / 100


def tile(page: Any, joint: str) -> tuple[float, float]:
    found = mark(page, f"tile-{joint}")
    return float(found.get_attribute("data-before")), float(found.get_attribute("data-after"))


def arm(page: Any) -> dict[str, Any]:
    """What the picture shows."""
    page.wait_for_function("document.querySelector('[data-mark=arm]')?.player")
    return page.evaluate("document.querySelector('[data-mark=arm]').arm.state()")


def rgb(colour: str) -> np.ndarray:
    return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], float)


def picture(page: Any, path: Path) -> None:
    """Take a picture of the whole page for the documents, once it is at rest."""
    size = page.viewport_size
    page.set_viewport_size({"width": 1440, "height": 1180})
    page.evaluate("scrollTo(0, 0)")
    page.wait_for_timeout(1500)
    page.screenshot(path=path)
    page.set_viewport_size(size)


def recorded(folder: Path, duration: float, *hidden: str) -> Path:
    """Write a log [s] of a UR5 with effects that its model lacks."""
    robot, rng = load_robot("ur5"), np.random.default_rng(4)
    time_, truth = np.arange(0, duration, 0.004), Dynamics(robot, tuple(parse_term(h) for h in hidden))
    q, v, a = exciting_trajectory(robot, rng, duration=duration)(time_)
    tau = truth.inverse_dynamics(q, v, a)
    tau += 0.01 * tau.std(axis=0) * rng.standard_normal(tau.shape)
    return write_log(Log(robot.joints, time_, 2e-5 * np.round(q / 2e-5), tau), folder / "run.csv")


def load_path(page: Any, log: Path) -> None:
    page.get_by_role("textbox", name="Robot").fill("ur5")
    page.get_by_role("textbox", name="Log", exact=True).fill(str(log))
    mark(page, "load").click()


# ------------------------------------------------------------------ the whole loop


def test_from_a_log_to_what_is_missing(tab, screenshots, tmp_path):
    load_demo(tab)
    begun = error(tab)
    assert read_percent(mark(tab, "error").inner_text()) == pytest.approx(begun, rel=0.02)
    mark(tab, "verdict").wait_for()
    chosen = tab.locator(".suggestion[data-confidence]")
    assert {s.get_attribute("data-effect") for s in chosen.all()} == {"payload", COULOMB}
    mark(tab, "tile-elbow_joint").click()
    tab.evaluate("document.querySelector('[data-mark=arm]').player.seek(11.6)")
    picture(tab, screenshots / "app-before.png")

    mark(tab, "preview-payload").click()
    mark(tab, "preview").wait_for()
    assert error(tab) == begun  # a preview changes no model
    assert tile(tab, "wrist_1_joint")[1] < 0.1 * tile(tab, "wrist_1_joint")[0]
    mark(tab, "add-preview").click()
    mark(tab, "version-1").wait_for()
    half = error(tab)
    assert half < 0.3 * begun

    mark(tab, f"add-{COULOMB}").click()
    mark(tab, "version-2").wait_for()
    assert error(tab) < 0.5 * half
    tab.locator('[data-mark="verdict"][data-verdict="nothing-missing"]').wait_for()
    before, after = tile(tab, "elbow_joint")
    assert after < 0.05 * before
    numbers = mark(tab, "tile-elbow_joint").locator(".numbers").inner_text().split("\n")
    assert read_percent(numbers[-1]) == pytest.approx(after, rel=0.02)

    mark(tab, "tile-elbow_joint").click()
    tab.wait_for_selector('[data-mark="charts"][data-joint="elbow_joint"] canvas')
    tab.evaluate("document.querySelector('[data-mark=arm]').player.seek(11.6)")
    picture(tab, screenshots / "app.png")
    with tab.expect_download() as kept:
        mark(tab, "export-model").click()
    kept.value.save_as(tmp_path / "model.json")
    model = load_model(tmp_path / "model.json", load_robot("ur5"))
    assert [t.label for t in model.terms] == ["payload", COULOMB]
    assert model.find(COULOMB).theta[0] == pytest.approx(5.0, rel=0.01)
    for what, name in (("urdf", "corrected.urdf"), ("report", "report.html"), ("python", "same.py")):
        with tab.expect_download() as kept:
            mark(tab, f"export-{what}").click()
        assert kept.value.suggested_filename == name

    mark(tab, "undo").click()
    tab.locator('[data-mark="version-1"][aria-pressed="true"]').wait_for()
    assert error(tab) == half
    mark(tab, "redo").click()
    tab.locator('[data-mark="version-2"][aria-pressed="true"]').wait_for()
    assert error(tab) < 0.5 * half


def test_the_colour_of_a_link_is_read_back_from_the_scene(tab):
    load_demo(tab)
    shown = arm(tab)["joints"]
    assert shown["wrist_1_joint"]["stage"] == "model error"
    legend = tab.locator(".arm3d-legend")
    assert re.fullmatch(
        r"model error: 0\s*\d+ % of the joint's torque", legend.inner_text().replace("\xa0", " ")
    )
    scale = legend.locator(".arm3d-scale")
    assert scale.bounding_box()["width"] > 40
    assert "rgb(213, 94, 0)" in scale.evaluate("(e) => getComputedStyle(e).backgroundImage")
    vermilion = rgb("#d55e00")
    far = lambda joints, j: np.abs(rgb(joints[j]["colour"]) - vermilion).sum()  # noqa: E731
    # at some time of the motion the worst joint is coloured, and hardly any more with the effects that it lacks
    search = """async (variant) => {
      const { arm, player } = document.querySelector('[data-mark=arm]');
      player.show(variant);
      let best = null;
      for (let t = player.begin; t < player.end; t += 0.5) {
        player.seek(t);
        const state = arm.state();
        if (!best || state.joints.wrist_1_joint.intensity > best.joints.wrist_1_joint.intensity) best = state;
      }
      return best;
    }"""
    worst = tab.evaluate(search, 0)["joints"]
    assert worst["wrist_1_joint"]["intensity"] > 0.6
    mark(tab, "verdict").wait_for()
    mark(tab, "add-found").click()
    mark(tab, "version-1").wait_for()
    mark(tab, "running").wait_for(state="hidden")
    better = tab.evaluate(search, 1)["joints"]
    assert better["wrist_1_joint"]["intensity"] < 0.1
    assert far(worst, "wrist_1_joint") < 0.7 * far(better, "wrist_1_joint")


def test_a_click_on_a_link_chooses_its_joint(tab):
    load_demo(tab)
    place = """(joint) => {
      const box = document.querySelector('[data-mark=arm]'), { arm } = box;
      const area = box.querySelector('.arm3d-view').getBoundingClientRect();
      for (let y = area.top + 6; y < area.bottom; y += 6)
        for (let x = area.left + 6; x < area.right; x += 6) if (arm.jointAt(x, y) === joint) return [x + 2, y + 2];
      return null;
    }"""
    tab.wait_for_function("document.querySelector('[data-mark=arm]')?.player")
    tab.wait_for_selector('[data-mark="charts"] canvas')
    tab.evaluate("document.querySelector('[data-mark=arm]').scrollIntoView()")
    at = tab.evaluate(place, "shoulder_lift_joint")
    assert at is not None
    tab.mouse.click(*at)
    tab.locator('[data-mark="tile-shoulder_lift_joint"][aria-pressed="true"]').wait_for()
    tab.wait_for_selector('[data-mark="charts"][data-joint="shoulder_lift_joint"]')
    assert arm(tab)["selected"] == "shoulder_lift_joint"


WORST = "shoulder_pan_joint"


def test_the_worst_joint_is_marked_at_every_width_whichever_is_selected(tab, tmp_path):
    load_path(tab, recorded(tmp_path, 15.0, f"coulomb_friction@{WORST}: level=9"))
    mark(tab, "loaded").wait_for()
    other = mark(tab, "tile-elbow_joint")
    other.click()
    tab.locator('[data-mark="tile-elbow_joint"][aria-pressed="true"]').wait_for()
    tile, marks = mark(tab, f"tile-{WORST}"), tab.locator(".tile .worst")
    assert tile.get_attribute("aria-pressed") == "false"
    assert tile.get_attribute("aria-label").endswith("the largest")
    for width in (1440, 1280, 1024, 420):
        tab.set_viewport_size({"width": width, "height": 860})
        tab.wait_for_timeout(200)
        assert marks.count() == 1
        box, seen = tile.bounding_box(), tile.locator(".worst").bounding_box()
        assert box["x"] < seen["x"] and seen["x"] + seen["width"] < box["x"] + box["width"], width
        assert box["y"] < seen["y"] and seen["y"] + seen["height"] < box["y"] + box["height"], width
        assert tile.locator(".name").evaluate("(e) => e.scrollWidth <= e.clientWidth"), width
    assert arm(tab)["selected"] == "elbow_joint"
    said = tab.locator(".arm3d-head").inner_text()
    assert "worst over the log: shoulder_pan" in said


def test_the_keyboard_is_enough(tab):
    tab.keyboard.press("Tab")
    for _ in range(30):
        if tab.evaluate("document.activeElement.dataset.mark") == "demo":
            break
        tab.keyboard.press("Tab")
    tab.keyboard.press("Enter")
    mark(tab, "verdict").wait_for()
    mark(tab, f"add-{COULOMB}").focus()
    tab.keyboard.press("Shift+Tab")
    assert tab.evaluate("document.activeElement.dataset.mark") == f"preview-{COULOMB}"
    tab.keyboard.press("Enter")
    mark(tab, "preview").wait_for()
    tab.wait_for_function("document.activeElement.textContent.trim().endsWith('Missing effects')")
    mark(tab, "tile-wrist_2_joint").focus()
    tab.keyboard.press("Space")
    tab.locator('[data-mark="tile-wrist_2_joint"][aria-pressed="true"]').wait_for()
    assert "preview" in mark(tab, "said").inner_text()


def test_every_button_has_a_name(tab):
    load_demo(tab)
    mark(tab, "verdict").wait_for()
    nameless = tab.evaluate(
        """[...document.querySelectorAll('button, input, select')].filter((e) => e.offsetParent)
           .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length || e.title))
           .map((e) => e.outerHTML)"""
    )
    assert nameless == []


# ------------------------------------------------------------------ what goes wrong


def test_a_bad_file_says_why_and_keeps_what_was_loaded(tab, tmp_path):
    load_demo(tab)
    begun = error(tab)
    bad = tmp_path / "bad.csv"
    bad.write_text("time,position.elbow_joint\n0,1\n")
    mark(tab, "change").click()
    tab.locator("input[type=file]").set_input_files(bad)  # and it is loaded at once
    tab.wait_for_function("document.querySelector('[data-mark=wrong]').textContent !== ''")
    said = mark(tab, "wrong").inner_text()
    assert "bad.csv" in said or "effort" in said or "no column" in said
    assert "Traceback" not in said
    assert tab.get_by_role("textbox", name="Log", exact=True).input_value() == "bad.csv"
    assert error(tab) == begun
    mark(tab, "own").locator("summary").first.click()
    mark(tab, "own-effect").fill("coulom_friction@elbow_joint")
    mark(tab, "own-add").click()
    tab.wait_for_function(
        "document.querySelector('[data-mark=wrong]').textContent.includes('coulomb_friction')"
    )
    assert error(tab) == begun


def test_a_search_can_be_cancelled(tab):
    # as soon as it is offered: the search may be over before a mouse gets there
    tab.evaluate(
        """() => new MutationObserver((_, watcher) => {
             const bar = document.querySelector('[data-mark=running][data-busy=yes]');
             if (!bar || !bar.textContent.startsWith("Searching for")) return;
             watcher.disconnect(); bar.querySelector('[data-mark=cancel]').click();
           }).observe(document.body, { childList: true, subtree: true, attributes: true, characterData: true })"""
    )
    load_demo(tab)
    mark(tab, "said").filter(has_text="Nothing has changed").wait_for()
    mark(tab, "search").wait_for()
    assert mark(tab, "verdict").count() == 0
    mark(tab, "search").click()
    mark(tab, "verdict").wait_for()


def test_wrong_units_are_found_and_put_right(tab, tmp_path):
    lines = DEMO.read_text().splitlines()
    at = [k for k, name in enumerate(lines[0].split(",")) if name.startswith("position")]
    rows = [line.split(",") for line in lines[1:2500]]
    for row in rows:
        for k in at:
            row[k] = f"{np.degrees(float(row[k])):.6f}"
    path = tmp_path / "degrees.csv"
    path.write_text("\n".join([lines[0], *(",".join(r) for r in rows)]))
    load_path(tab, path)
    mark(tab, "apply-angle=deg").first.click()
    mark(tab, "check-ok").wait_for()
    assert error(tab) < 1.0


def test_two_tabs_do_not_disturb_each_other(tab, chromium, app):
    other = chromium.new_context().new_page()
    other.set_default_timeout(PATIENCE)
    other.goto(app.entry)
    load_demo(tab)
    assert mark(other, "loaded").count() == 0
    load_demo(other)
    mark(other, "verdict").wait_for()
    mark(other, "add-payload").click()
    mark(other, "version-1").wait_for()
    assert mark(tab, "version-1").count() == 0
    assert error(other) < error(tab)
    other.context.close()


# ------------------------------------------------------------------ a log of usual length


@pytest.fixture(scope="module")
def minute(tmp_path_factory) -> Path:
    """A minute of a UR5 with friction that its model lacks."""
    return recorded(tmp_path_factory.mktemp("log"), 60.0, f"{COULOMB}: level=5")


def test_what_is_missing_is_added_to_a_minute(page, minute):
    """How soon it is there is measured by ``python -m benchmarks.pages``."""
    served = Served(str(minute), "--robot", "ur5")
    try:
        page.set_default_timeout(PATIENCE)
        page.goto(served.entry)
        mark(page, "verdict").wait_for()
        mark(page, f"add-{COULOMB}").click()
        page.locator('[data-mark="version-1"][aria-pressed="true"]').wait_for()
        assert error(page) < 0.05
    finally:
        served.interrupt()


def test_the_tail_of_a_long_result_is_folded(page, tmp_path, screenshots):
    joints = load_robot("ur5").joints
    levels, offsets = (8, 6, 5, 2, 1.5, 1), (5, 4, 3, 1, 1, 0.5)  # [N·m]
    hidden = [f"coulomb_friction@{j}: level={x}" for j, x in zip(joints, levels, strict=True)]
    hidden += [f"torque_offset@{j}: offset={x}" for j, x in zip(joints, offsets, strict=True)]
    hidden += [f"rotor_inertia@{joints[0]}: inertia=0.5", f"viscous_friction@{joints[1]}: coefficient=8"]
    hidden += ["payload: mass=1, first_moment_z=0.1"]
    served = Served(str(recorded(tmp_path, 40.0, *hidden)), "--robot", "ur5")
    try:
        page.set_default_timeout(PATIENCE)
        page.goto(served.entry)
        mark(page, "verdict").wait_for()
        cards = page.locator("[data-effect]")
        assert cards.count() >= 10
        assert sum(card.is_visible() for card in page.locator(".suggestion").all()) <= 5
        assert page.evaluate("document.documentElement.scrollHeight") <= 3000  # [px]
        picture(page, screenshots / "app-long.png")
        tail = mark(page, "others")
        folded = tail.locator("[data-effect]")
        assert folded.count() >= 2 and not folded.first.is_visible()
        tail.locator("summary").first.click()
        assert all(card.is_visible() for card in folded.all())
        quiet(page, served)
    finally:
        served.interrupt()


# ------------------------------------------------------------------ while it moves


def test_faults_switched_while_an_arm_moves(page, app, screenshots):
    page.set_default_timeout(PATIENCE)
    page.set_viewport_size({"width": 1180, "height": 900})
    page.goto(app.entry)
    page.goto(app.address + "/live")
    mark(page, "begin").click()
    mark(page, "fault-0").wait_for()
    assert mark(page, "fault-0").get_attribute("aria-checked") == "false"
    page.wait_for_selector('[data-mark="live-tile-elbow_joint"][data-stage="healthy"]')
    mark(page, "fault-0").click()
    page.locator('[data-mark="fault-0"][aria-checked="true"]').wait_for()
    page.wait_for_selector('[data-mark="live-tile-elbow_joint"][data-stage="accommodated"]')
    named = page.locator('[data-mark="event"][data-stage*="accommodation"]', has_text="friction").first
    named.wait_for()
    assert "elbow" in named.inner_text()
    # the picture, which moves evenly, is a fraction of a second behind the tiles
    blue = page.wait_for_function(
        """() => { const shown = document.querySelector("[data-mark=arm]").arm.state().joints.elbow_joint;
           return shown.stage === "accommodated" && shown; }"""
    ).json_value()
    assert np.abs(rgb(blue["colour"]) - rgb("#0072b2")).sum() < 120
    picture(page, screenshots / "app-live.png")
    mark(page, "fault-0").click()
    page.wait_for_selector('[data-mark="live-tile-elbow_joint"][data-stage="idle"]')
    mark(page, "pause").click()
    page.get_by_role("button", name="Go on").wait_for()
    mark(page, "stop").click()
    mark(page, "stop").wait_for(state="detached")
    quiet(page, app)


def test_a_reload_finds_the_run_its_form_and_its_events(page, app):
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    page.goto(app.address + "/live")
    page.get_by_label("Robot", exact=True).fill("double_pendulum")
    page.get_by_label("Faults to switch, one a line").fill("viscous_friction@joint2: coefficient=0.1")
    mark(page, "begin").click()
    mark(page, "fault-0").click()
    event = mark(page, "event").first
    event.wait_for()
    clock = "Number(document.querySelector('[data-mark=speed]').textContent.match(/([0-9]+) s/)?.[1])"
    page.wait_for_function(f"{clock} > 2")
    moved = page.evaluate(clock)
    page.reload()
    page.locator('[data-mark="fault-0"][aria-checked="true"]').wait_for()
    event.wait_for()
    page.wait_for_function(f"{clock} >= {moved}")
    page.wait_for_selector('[data-mark="live-tile-joint2"][data-stage]')
    page.wait_for_function("document.querySelector('[data-mark=arm]')?.player?.end > 0")
    assert page.get_by_label("Robot", exact=True).input_value() == "double_pendulum"
    assert "viscous_friction@joint2" in page.get_by_label("Faults to switch, one a line").input_value()
    # and when it has ended
    mark(page, "stop").click()
    mark(page, "stop").wait_for(state="detached")
    page.reload()
    event.wait_for()
    mark(page, "begin").wait_for()
    assert mark(page, "stop").count() == 0
    quiet(page, app)


def test_a_log_is_replayed(page, app, minute):
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    page.goto(app.address + "/live")
    mark(page, "what-replay").click()
    page.get_by_role("textbox", name="Log", exact=True).fill(str(minute))
    mark(page, "begin").click()
    page.wait_for_selector('[data-mark="live-tile-elbow_joint"][data-stage]')
    assert "taken as healthy" in mark(page, "said").inner_text()
    page.get_by_role("textbox", name="Log", exact=True).fill("none.csv")
    mark(page, "begin").click()
    page.wait_for_function("document.querySelector('[data-mark=wrong]').textContent.includes('none.csv')")
    quiet(page, app)


def test_ctrl_c_ends_the_app_though_an_arm_moves_in_a_tab(page):
    served = Served()
    page.set_default_timeout(PATIENCE)
    page.goto(served.entry)
    page.goto(served.address + "/live")
    mark(page, "begin").click()
    mark(page, "fault-0").wait_for()
    assert served.interrupt() in {0, 130}
    assert "Traceback" not in "".join(served.said)
