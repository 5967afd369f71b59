"""Results in a notebook: shown by IPython as they are, without scripts, in light and dark."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, discover, exciting_trajectory, load_robot, simulate
from cdia_pin.diagnosis import Monitor, replay
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.effects import parse_term
from cdia_pin.selection import DiscoverySettings

LEVEL = 5.0  # [N·m] of the friction that the model lacks


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
        "discovery": discover(
            model, log, settings=DiscoverySettings(effects=("coulomb_friction", "viscous_friction"))
        ),
        "run": replay(Monitor(model, healthy=[measured(3, 12.0)]), faulty),
    }


@pytest.mark.parametrize("name", ["comparison", "discovery", "run"])
def test_ipython_shows_it_as_html(results: dict[str, Any], name: str):
    from IPython.core.formatters import DisplayFormatter

    shown, _ = DisplayFormatter().format(results[name])
    assert shown["text/html"] == results[name]._repr_html_()
    assert "<script" not in shown["text/html"]
    assert len(shown["text/html"]) < 60_000


def test_importing_the_package_is_enough():
    code = """
import cdia_pin, sys
assert 'cdia_pin.viewers' not in sys.modules
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
shell.run_cell('import cdia_pin; robot = cdia_pin.load_robot("scara"); model = cdia_pin.Dynamics(robot)')
shell.run_cell('import numpy as np; rng = np.random.default_rng(0)')
shell.run_cell('motion = cdia_pin.exciting_trajectory(robot, rng, duration=5.0)')
shell.run_cell('log = cdia_pin.simulate(model, motion, rate=200.0)')
result = shell.run_cell('cdia_pin.compare(model, log)').result
print(shell.display_formatter.format(result)[0]['text/html'])
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "The model of scara misses the measured torque by" in run.stdout


def test_what_is_shown_is_what_was_found(results: dict[str, Any]):
    discovery = results["discovery"]._repr_html_()
    assert "coulomb friction" in discovery
    (level,) = re.findall(r"level (\d\.\d+) ±", discovery)
    assert float(level) == pytest.approx(LEVEL, rel=0.02)
    run = results["run"]._repr_html_()
    assert "joint1" in run
    assert "coulomb friction: level" in run
    rows = results["comparison"]._repr_html_().count("<tr>")
    assert rows == 1 + 4


def test_names_are_never_markup(results: dict[str, Any]):
    from dataclasses import replace

    comparison = results["comparison"]
    wicked = replace(comparison, worst_regions=(replace(comparison.worst_regions[0], joint="<img src=x>"),))
    assert "<img" not in wicked._repr_html_()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_can_be_read_on_light_and_on_dark(
    page: Any, results: dict[str, Any], scheme: str, screenshots: Path
):
    ink, paper = ("#111", "#fff") if scheme == "light" else ("#e0e0e0", "#111")
    body = "<hr>".join(r._repr_html_() for r in results.values())
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
