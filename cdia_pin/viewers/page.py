"""A page: one HTML file that opens from disk, without network, years from now."""

from __future__ import annotations

import html
import json
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from string import Template

from cdia_pin.errors import CdiaError
from cdia_pin.viewers.scene import scene_assets
from cdia_pin.whole_files import write_whole

LARGEST = 6_000_000  # bytes
CHART_SCRIPTS = ("base.js", "charts.js", "charts_joint.js")  # after uPlot, in this order
POINTS = (2000, 1000, 500, 250, 100)  # samples of a curve, the most that fits


def write_page(
    path: str | Path,
    data: Callable[[int], Mapping[str, object]],
    scene: Mapping[str, object],
    script: str,
    sentences: Sequence[str] = (),
) -> Path:
    """Write a page of at most 6 MB; the same data give the same bytes.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        data: Returns what is shown, with its ``title``, for a largest number of samples of a curve.
        scene: The arm and its motion, of `report_scene`.
        script: Name of the asset that builds the page from the data.
        sentences: Shown where scripts do not run.

    Raises:
        CdiaError: If the file cannot be written.
    """
    page = b""
    for points in POINTS:
        page = _page(data(points), scene, script, sentences)
        if len(page) <= LARGEST:
            break
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, page)
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None
    return path


def embeddable(data: object) -> str:
    """Return JSON that can stand inside a script element: ``<``, ``>`` and ``&`` are escaped.

    Args:
        data: Anything that JSON can hold.
    """
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _page(
    data: Mapping[str, object], scene: Mapping[str, object], script: str, sentences: Sequence[str]
) -> bytes:
    arm = scene_assets()
    page = Template(asset("report.html")).substitute(
        title=html.escape(str(data["title"])),
        summary=html.escape(" ".join(sentences)),
        licence=f"{asset('uPlot.LICENSE')}\nThe arm is drawn by meshcat:\n{arm.licence}".replace("--", "- -"),
        arm_style=arm.style,
        meshcat=arm.meshcat,
        arm_script=arm.script,
        scene=embeddable(scene),
        uplot_style=asset("uPlot.min.css"),
        charts_style=asset("charts.css"),
        uplot=asset("uPlot.iife.min.js"),
        data=embeddable(data),
        script="\n".join(asset(name) for name in (*CHART_SCRIPTS, "page.js", "motion.js", script)),
    )
    return page.encode("utf-8", errors="replace")


def asset(name: str) -> str:
    """Return the text of an asset.

    Args:
        name: Of a file in ``viewers/assets``.
    """
    return (files("cdia_pin.viewers") / "assets" / name).read_text(encoding="utf-8")
