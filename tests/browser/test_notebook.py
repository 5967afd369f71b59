"""Results in a notebook: shown by IPython as they are, without scripts, in light and dark."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, discover, exciting_trajectory, load_robot, simulate
from cdia_pin.diagnosis import Monitor, replay
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.effects import parse_term
from cdia_pin.ipython import SHOWN, register_html
from cdia_pin.selection import DiscoverySettings
from cdia_pin.viewers.notebook import html_of

LEVEL = 5.0  # [N·m] of the friction that the model lacks
FRICTION = ("coulomb_friction", "viscous_friction")


def measured(seed: int, duration: float, *faults: str) -> Any:
    robot = load_robot("scara")
    motion_of, noise = np.random.default_rng(seed).spawn(2)
    motion = exciting_trajectory(robot, motion_of, duration=duration)
    plant = Dynamics(robot, tuple(parse_term(f) for f in faults))
    return simulate(plant, motion, rate=250.0, sensors=Sensors(effort_share=0.01), rng=noise)


@pytest.fixture(scope="module")
def results() -> dict[str, Any]:
    model = Dynamics(load_robot("scara"))
    log = measured(1, 12.0, f"coulomb_friction@joint1: level={LEVEL:g}")
    faulty = measured(2, 12.0, f"coulomb_friction@joint1: level={LEVEL:g}, after=6")
    return {
        "comparison": compare(model, log),
        "discovery": discover(model, log, settings=DiscoverySettings(effects=FRICTION)),
        "run": replay(Monitor(model, healthy=[measured(3, 12.0)], bank=FRICTION), faulty),
    }


@pytest.mark.parametrize("name", ["comparison", "discovery", "run"])
def test_ipython_shows_it_as_html(results: dict[str, Any], name: str):
    from IPython.core.formatters import HTMLFormatter

    shown = HTMLFormatter()
    register_html(shown)
    html = shown(results[name])
    assert html == html_of(results[name])
    assert "<script" not in html
    assert len(html) < 60_000


@pytest.mark.parametrize(("module", "name"), SHOWN)
def test_ipython_knows_the_types_by_the_names_that_they_have(module: str, name: str):
    kind = getattr(import_module(module), name)
    assert (kind.__module__, kind.__name__) == (module, name)


@pytest.mark.parametrize("first", ["", "import cdia_pin"])
def test_importing_the_package_is_enough(first: str):
    code = f"""
{first}
import sys
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
{"shell.run_cell('%load_ext cdia_pin')" if first else ""}
shell.run_cell('import cdia_pin')
assert 'cdia_pin.viewers' not in sys.modules
shell.run_cell('robot = cdia_pin.load_robot("scara"); model = cdia_pin.Dynamics(robot)')
shell.run_cell('import numpy as np; rng = np.random.default_rng(0)')
shell.run_cell('motion = cdia_pin.exciting_trajectory(robot, rng, duration=5.0)')
shell.run_cell('log = cdia_pin.simulate(model, motion, rate=200.0)')
result = shell.run_cell('cdia_pin.compare(model, log)').result
print(shell.display_formatter.format(result)[0]['text/html'])
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "The model of scara differs from the measured torque by" in run.stdout


def test_what_is_shown_is_what_was_found(results: dict[str, Any]):
    discovery = html_of(results["discovery"])
    assert "coulomb friction" in discovery
    (level,) = set(re.findall(r"level (\d\.\d+) ±", discovery))  # in the line of its group, and in the table
    assert float(level) == pytest.approx(LEVEL, rel=0.02)
    run = html_of(results["run"])
    assert "joint1" in run
    assert "coulomb friction: level" in run
    rows = html_of(results["comparison"]).count("<tr>")
    assert rows == 1 + 4


def test_names_are_never_markup(results: dict[str, Any]):
    from dataclasses import replace

    comparison = results["comparison"]
    wicked = replace(comparison, worst_regions=(replace(comparison.worst_regions[0], joint="<img src=x>"),))
    assert "<img" not in html_of(wicked)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_can_be_read_on_light_and_on_dark(
    page: Any, results: dict[str, Any], scheme: str, screenshots: Path
):
    ink, paper = ("#111", "#fff") if scheme == "light" else ("#e0e0e0", "#111")
    body = "<hr>".join(html_of(r) for r in results.values())
    page.set_content(f"<body style='background:{paper};color:{ink};font:14px sans-serif'>{body}")
    inks = set(
        page.evaluate(
            "Array.from(document.querySelectorAll('.cdia-pin td'), (c) => getComputedStyle(c).color)"
        )
    )
    assert len(inks) == 1  # that of the notebook
    pictures = page.locator(".cdia-pin svg")
    assert pictures.count() >= 4 + 4 + 1 + 4
    for k in range(pictures.count()):
        box = pictures.nth(k).bounding_box()
        assert box["width"] > 50
        assert box["height"] > 10
    page.screenshot(path=screenshots / f"notebook-{scheme}.png", full_page=True)
    assert page.seen.errors == []
