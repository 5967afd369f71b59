"""Scripts and styles that the pages ask for: those of the reports, meshcat's viewer, and the app's own."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.resources import files

from cdia_pin.viewers.page import asset
from cdia_pin.viewers.scene import scene_assets

SCRIPT, STYLE = "text/javascript", "text/css"

# One moment for all charts and the arm of a page.
CLOCK = """
Cdia.clock = (() => { let clock = null; return () => (clock = clock || new Charts.Clock()); })();
"""


@cache
def served(name: str) -> tuple[str, str]:
    """Return kind and text of what is served under a name; raises KeyError if there is none."""
    kind, text = SERVED[name]
    return kind, text()


def style() -> str:
    """Return the one style sheet of the pages."""
    parts = (asset("uPlot.min.css"), asset("charts.css"), scene_assets().style, own("app.css"))
    return "\n".join(parts)


def own(name: str) -> str:
    """Return the text of one of the app's own assets."""
    return (files("cdia_pin.app") / "assets" / name).read_text(encoding="utf-8")


def shared(name: str, defines: str) -> str:
    """Return a script of the reports that defines a constant, so that modules see it too."""
    return f"{asset(name)}\nglobalThis.{defines} = {defines};\n"


SERVED: dict[str, tuple[str, Callable[[], str]]] = {
    "load.js": (SCRIPT, lambda: own("load.js")),
    "base.js": (SCRIPT, lambda: shared("base.js", "Cdia")),
    "uPlot.js": (SCRIPT, lambda: asset("uPlot.iife.min.js")),
    "charts.js": (SCRIPT, lambda: shared("charts.js", "Charts") + CLOCK),
    "charts_joint.js": (SCRIPT, lambda: shared("charts_joint.js", "JointCharts")),
    "meshcat.js": (SCRIPT, lambda: scene_assets().meshcat),
    "arm3d.js": (SCRIPT, lambda: scene_assets().script),
    "style.css": (STYLE, style),
}
