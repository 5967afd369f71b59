"""The app with a user's own files: a URDF without its meshes, currents, foreign names, and a reload."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdia_pin import Dynamics, exciting_trajectory, load_robot
from cdia_pin.effects import parse_term
from tests.browser.served_app import PATIENCE, Served, error, mark, quiet, reachable

BODY = """<link name="{0}"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial>
  <visual><geometry><mesh filename="package://arm/meshes/{0}.stl"/></geometry></visual></link>"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/>
  <axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5" velocity="4" effort="90"/></joint>"""
ARM = f"""<robot name="arm"><link name="base"/>{BODY.format("upper")}{BODY.format("lower")}
  {JOINT.format("shoulder", "base", "upper", "0 0 0.5")}{JOINT.format("elbow", "upper", "lower", "0.4 0 0")}</robot>"""
STL = """solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 0.4 0 0
vertex 0.4 0.1 0
endloop
endfacet
endsolid a
"""
GAINS = {"shoulder": 12.0, "elbow": 8.0}  # [N·m/A]
COULOMB = "coulomb_friction@elbow"


@pytest.fixture(scope="module")
def app() -> Iterator[Served]:
    served = Served()
    yield served
    served.interrupt()
    assert "Traceback" not in "".join(served.said), "".join(served.said)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A URDF, one of its meshes, gains, and a log of currents whose joints have names of their own."""
    folder = tmp_path_factory.mktemp("files")
    (folder / "arm.urdf").write_text(ARM)
    (folder / "upper.stl").write_text(STL)
    (folder / "gains.json").write_text(json.dumps({**GAINS, "elbow": {"value": 8.0, "tolerance": 0.4}}))
    robot, rng = load_robot(folder / "arm.urdf"), np.random.default_rng(3)
    truth = Dynamics(robot, (parse_term(f"{COULOMB}: level=3"),))
    time = 100.0 + np.arange(0.0, 20.0, 0.004)
    q, v, a = exciting_trajectory(robot, rng, duration=20.0)(time - 100.0)
    tau = truth.inverse_dynamics(q, v, a)
    tau += 0.01 * tau.std(axis=0) * rng.standard_normal(tau.shape)
    names = ["time", *(f"{s}.{j}" for s in ("position", "current") for j in ("first", "second"))]
    columns = np.column_stack([time, q, tau / list(GAINS.values())])
    np.savetxt(folder / "run.csv", columns, "%.7f", ",", header=",".join(names), comments="")
    return folder


def cursor_at(page: Any, moment: float) -> float:
    """Let the player go to a moment [s]; return where the torque chart has its cursor, as a share of its width."""
    page.evaluate("(t) => document.querySelector('[data-mark=arm]').player.seek(t)", moment)
    return page.evaluate("""() => { const over = document.querySelector('[data-mark=charts] .u-over');
      const { transform } = over.querySelector('.u-cursor-x').style;
      return Number(transform.match(/translate\\((-?[0-9.]+)px/)[1]) / over.clientWidth; }""")


def drop(page: Any, *paths: Path) -> None:
    """Drop files on the page."""
    page.evaluate("() => { globalThis.dropped = new DataTransfer(); }")
    for path in paths:
        page.evaluate(
            "([name, text]) => globalThis.dropped.items.add(new File([text], name))",
            [path.name, path.read_text()],
        )
    page.evaluate(
        """() => document.dispatchEvent(
             new DragEvent("drop", { dataTransfer: globalThis.dropped, bubbles: true, cancelable: true }))"""
    )


def test_from_dropped_files_to_an_added_effect_that_a_reload_keeps(page, app, files, chromium):
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    mark(page, "load").wait_for()
    # the robot is read first: its arm is seen, with one line on its meshes
    drop(page, files / "arm.urdf")
    notes = page.locator(".arm3d-notes summary")
    notes.wait_for()
    assert notes.inner_text().startswith("2 meshes missing")
    assert not page.get_by_text("there is no mesh").first.is_visible()
    notes.click()
    assert page.get_by_text("package://arm/meshes/upper.stl").is_visible()
    drop(page, files / "upper.stl")
    page.get_by_text("1 mesh missing").wait_for()
    # a log that does not fit opens the table, with the names that it has
    drop(page, files / "run.csv")
    mark(page, "mapping-fault").wait_for()
    assert mark(page, "label-shoulder").input_value() == "first"
    mark(page, "gain-shoulder").fill("twelve")
    mark(page, "load").click()
    page.get_by_text("must be a number, given 'twelve'").first.wait_for()
    assert mark(page, "gain-shoulder").input_value() == "twelve"
    drop(page, files / "gains.json")
    mark(page, "verdict").wait_for()
    begun = error(page)
    # a typo keeps its text
    mark(page, "own").locator("summary").click()
    mark(page, "own-effect").fill("coulom_friction@elbow")
    mark(page, "own-add").click()
    assert "coulomb_friction" in mark(page, "own-fault").inner_text()
    assert mark(page, "own-effect").input_value() == "coulom_friction@elbow"
    mark(page, "own-effect").fill(COULOMB)
    mark(page, "own-add").click()
    mark(page, "version-1").wait_for()
    assert error(page) < 0.2 * begun
    # player and charts have the log's clock, once they are drawn again for the model with the effect
    mark(page, "charts").get_by_text("improved").first.wait_for()
    assert page.locator(".arm3d-time").inner_text().startswith("100.")
    assert cursor_at(page, 105.0) == pytest.approx(0.25, abs=0.02)
    assert cursor_at(page, 115.0) == pytest.approx(0.75, abs=0.02)
    over = page.locator('[data-mark="charts"] .u-over').first
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_function("Math.abs(document.querySelector('[data-mark=arm]').player.time - 110) < 0.4")
    page.mouse.move(1, 1)
    # loading the page again changes nothing
    left = error(page)
    page.reload()
    mark(page, "version-1").wait_for()
    assert error(page) == left
    assert "run.csv" in mark(page, "loaded").inner_text()
    page.wait_for_function("document.querySelector('[data-mark=arm]')?.player")
    # the address alone is of no use to another browser
    stranger = chromium.new_context().new_page()
    assert stranger.goto(page.url).status == 403
    stranger.context.close()
    quiet(page, app)


def test_gains_that_are_typed_load_a_log_of_currents(page, app, files):
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    mark(page, "load").wait_for()
    drop(page, files / "arm.urdf", files / "run.csv")
    mark(page, "mapping-fault").wait_for()
    mark(page, "gain-shoulder").fill("12")
    mark(page, "gain-elbow").fill("8 ± 0.4")
    mark(page, "load").click()
    mark(page, "verdict").wait_for()
    begun = error(page)
    lines = mark(page, "python-lines").text_content()
    assert "'shoulder': 12.0" in lines and "'tolerance': 0.4" in lines
    mark(page, f"add-{COULOMB}").click()
    mark(page, "version-1").wait_for()
    assert error(page) < 0.2 * begun
    quiet(page, app)


@pytest.fixture(scope="module")
def foreign(files: Path) -> Path:
    """The same log without its currents, in columns of somebody's own names and in degrees."""
    rows = (files / "run.csv").read_text().splitlines()[1:]
    t, q, current = np.split(np.array([row.split(",") for row in rows], float), [1, 3], axis=1)
    columns = np.hstack([t, np.degrees(q), current * list(GAINS.values())])
    names = ["zeit", *(f"A{k} {signal}" for signal in ("winkel", "kraft") for k in (1, 2))]
    np.savetxt(files / "plc.csv", columns, "%.7f", ",", header=",".join(names), comments="")
    return files / "plc.csv"


def test_columns_of_any_names_are_chosen_at_the_error(page, app, files, foreign, screenshots):
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    mark(page, "load").wait_for()
    drop(page, files / "arm.urdf", foreign)
    mark(page, "mapping-fault").wait_for()
    assert "no position columns" in mark(page, "mapping-fault").inner_text()
    position, effort = (mark(page, f"columns-{signal}") for signal in ("position", "effort"))
    assert position.input_value() == "A# winkel" and effort.input_value() == "A# kraft"
    page.screenshot(path=screenshots / "app-columns.png", full_page=True)
    # what is chosen otherwise is what is read
    effort.select_option("")
    mark(page, "load").click()
    page.get_by_text("no effort columns").first.wait_for()
    effort.select_option("A# kraft")
    mark(page, "load").click()
    mark(page, "verdict").wait_for()
    begun = error(page)
    mark(page, f"add-{COULOMB}").click()
    mark(page, "version-1").wait_for()
    assert error(page) < 0.2 * begun
    quiet(page, app)


EXPORTS = ("export-model", "export-urdf", "export-report", "export-python")


def test_a_phone_needs_no_scrolling_sideways_and_has_export_in_reach(page, app, screenshots):
    page.set_viewport_size({"width": 420, "height": 800})
    page.set_default_timeout(PATIENCE)
    page.goto(app.entry)
    mark(page, "demo").click()
    mark(page, "loaded").wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") <= 420
    mark(page, "verdict").wait_for()
    for share in (0.0, 0.5, 1.0):  # of the page
        page.evaluate("(share) => scrollTo(0, share * document.documentElement.scrollHeight)", share)
        page.wait_for_timeout(200)
        page.screenshot(path=screenshots / f"app-phone-{share:g}.png")
        assert all(reachable(page, export) for export in EXPORTS), share
    # nothing is left behind the bar at the end of the page
    step, bar = (mark(page, name).bounding_box() for name in ("step-missing", "step-export"))
    assert step["y"] + step["height"] <= bar["y"] + 1
    # what the keyboard goes to is not behind it either
    mark(page, "change").focus()
    below = """() => { const bar = document.querySelector('[data-mark=step-export]'), e = document.activeElement;
      return bar.contains(e) ? null : e.getBoundingClientRect().bottom - bar.getBoundingClientRect().top; }"""
    passed = []  # [px], lower ends below the upper edge of the bar
    while (lower := page.evaluate(below)) is not None:
        passed.append(lower)
        page.keyboard.press("Tab")
    assert len(passed) > 8 and max(passed) <= 0
    mark(page, "change").click()
    mark(page, "mapping").locator("summary").click()
    assert page.evaluate("document.documentElement.scrollWidth") <= 420
    box = mark(page, "export-urdf").bounding_box()
    assert 0 < box["y"] < 800
