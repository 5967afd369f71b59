"""Results in a notebook: IPython learns here which function shows which result.

IPython keeps its formatters by the name of a type, so that results need not know their viewers and viewers are not
imported before a result is shown.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

# Module and name of each type that a notebook shows as HTML.
SHOWN = (
    ("cdia_pin.discovery.comparison", "Comparison"),
    ("cdia_pin.discovery.discovery_result", "Discovery"),
    ("cdia_pin.diagnosis.record", "MonitorRun"),
)


def register_html(html_formatter: Any) -> None:
    """Register the results with a formatter of IPython.

    Args:
        html_formatter: Its ``HTMLFormatter``.
    """
    for module, name in SHOWN:
        html_formatter.for_type_by_name(module, name, _html)


def register_with_running_ipython() -> None:
    """Register the results with the shell that runs this process, if there is one."""
    if "IPython" in sys.modules and (shell := sys.modules["IPython"].get_ipython()):
        register_html(shell.display_formatter.formatters["text/html"])


def _html(result: object) -> str:
    html: str = import_module("cdia_pin.viewers.notebook").html_of(result)
    return html
