"""Figures of the thesis' numerical studies, as PNG ([Thesis] figures 10 to 21)."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.campaigns.scara_run import UNITS, ScaraRun
from cdia_pin.campaigns.thesis_study import Case, ThesisStudy
from cdia_pin.extras import require

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

INK, LINE = "#1c2126", "#dfe3e8"
STYLES = {  # distinguishable without colours too; colours of Okabe and Ito
    "healthy": {"color": "#009e73", "linestyle": (0, (1, 1.2)), "linewidth": 1.9, "zorder": 4},
    "faulty": {"color": "#d55e00", "linestyle": (0, (5, 2)), "linewidth": 1.3, "zorder": 2},
    "accommodated": {"color": "#0072b2", "linestyle": "-", "linewidth": 1.4, "zorder": 3},
}
BAND = "#e69f00"
DPI = 110
POINTS = 2000  # samples of a curve
NARROW = 12.0  # [1], largest value over the middle of the scale that a linear one still shows


@dataclass(frozen=True)
class Picture:
    """A figure of a study.

    Attributes:
        name: Of its file, without suffix.
        title: What it shows.
        caption: How to read it.
        png: The image.
    """

    name: str
    title: str
    caption: str
    png: bytes


def thesis_pictures(study: ThesisStudy) -> Iterator[Picture]:
    """Yield the figures of the last case of each preset, then those of the isolation study.

    Args:
        study: The numbers.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    for name, cases in study.cases.items():
        yield from _of_case(study, f"{name}_observer", cases[-1])
    yield from _of_case(study, "isolation", study.isolation_case)


def _of_case(study: ThesisStudy, stem: str, case: Case) -> Iterator[Picture]:
    runs = {"healthy": case.healthy, "faulty": case.faulty, "accommodated": case.accommodated}
    errors: tuple[tuple[str, str, str, Callable[[ScaraRun], Array]], ...] = (
        ("position", "q − q_d", "", lambda r: r.q_error),
        ("velocity", "q̇ − q̇_d", "/s", lambda r: r.v_error),
    )
    for what, symbol, per, signal in errors:
        yield Picture(
            f"{stem}_{what}_error",
            f"{what.capitalize()} error: {case.name}",
            f"{symbol} of each joint; dotted upright lines: a fault begins. Where a scale is logarithmic, it is"
            " linear up to three times the healthy error.",
            _grid(study, case, partial(_errors, runs, signal), symbol, per),
        )
    yield Picture(
        f"{stem}_estimation_error",
        f"Velocity estimation error: {case.name}",
        "e of the observer in the accommodated run, and ± its threshold; a logarithmic scale is linear up to "
        "the threshold. Beyond it a fault is declared, and weights adapt.",
        _grid(study, case, partial(_estimation, case.accommodated), "e", "/s"),
    )


def _grid(study: ThesisStudy, case: Case, draw: Callable[[Axes, int], None], symbol: str, per: str) -> bytes:
    """Draw one panel per joint."""
    figure = new_figure()
    panels = figure.subplots(2, 2, sharex=True).flat
    onsets = sorted({case.began, *_onsets(study, case)})
    for j, (axes, joint, unit) in enumerate(zip(panels, study.joints, UNITS, strict=True)):
        draw(axes, j)
        for onset in onsets:
            axes.axvline(onset, color=INK, linewidth=0.9, linestyle=":", zorder=1)
        axes.set_title(joint, fontsize=10, loc="left", color=INK)
        axes.set_ylabel(f"{symbol} [{unit}{per}]", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(color=LINE, linewidth=0.6)
        axes.set_axisbelow(True)
        axes.margins(x=0)
        axes.spines[["top", "right"]].set_visible(False)
        if j >= 2:
            axes.set_xlabel("time [s]", fontsize=9)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.subplots_adjust(left=0.085, right=0.985, bottom=0.085, top=0.9, wspace=0.2, hspace=0.16)
    figure.legend(handles, labels, loc="upper center", ncols=len(labels), fontsize=9, frameon=False)
    out = io.BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()


def _errors(runs: dict[str, ScaraRun], signal: Callable[[ScaraRun], Array], axes: Axes, j: int) -> None:
    for kind, one in runs.items():
        thin = max(len(one.time) // POINTS, 1)
        axes.plot(one.time[::thin], signal(one)[::thin, j], label=kind, **STYLES[kind])  # type: ignore[arg-type]
    healthy = signal(runs["healthy"])
    linear = 3.0 * np.abs(healthy[len(healthy) // 2 :]).max(axis=0)
    scale(axes, j, linear, np.array([np.abs(signal(r)).max(axis=0) for r in runs.values()]).max(axis=0))


def _estimation(run: ScaraRun, axes: Axes, j: int) -> None:
    thin = max(len(run.time) // POINTS, 1)
    time, bound = run.time[::thin], run.threshold[::thin, j]
    axes.fill_between(time, -bound, bound, color=BAND, alpha=0.3, linewidth=0, label="± threshold", zorder=1)
    axes.plot(time, bound, color=BAND, linewidth=1.0, zorder=3)
    axes.plot(time, -bound, color=BAND, linewidth=1.0, zorder=3)
    axes.plot(
        time, run.residual[::thin, j], color="#0072b2", linewidth=0.9, label="estimation error e", zorder=2
    )
    scale(axes, j, run.threshold.max(axis=0), np.abs(run.residual).max(axis=0))


def scale(axes: Axes, j: int, linear: Array, most: Array) -> None:
    """Scale all panels of a figure alike, logarithmically outside a linear middle where one of them needs it.

    Args:
        axes: Panel of a joint.
        j: Its index.
        linear: Half the middle of each joint, (n,).
        most: Largest value of each joint, (n,).
    """
    from matplotlib.ticker import MaxNLocator

    if (most <= NARROW * linear).all():
        axes.yaxis.set_major_locator(MaxNLocator(5))
        return
    axes.set_yscale("symlog", linthresh=float(linear[j]), linscale=1.0)
    low, high = int(np.ceil(np.log10(linear[j]))), int(np.floor(np.log10(most[j])))
    powers = [10.0**k for k in range(max(high, low), low - 1, -max((high - low) // 2, 1))]
    axes.set_yticks([-p for p in powers] + [0.0] + powers[::-1])
    axes.minorticks_off()
    reach = 1.6 * max(float(most[j]), powers[0])
    axes.set_ylim(-reach, reach)


def _onsets(study: ThesisStudy, case: Case) -> list[float]:
    for preset in study.presets.values():
        if case.name in preset.cases:
            return [f.start for f in preset.cases[case.name].faults]
    return []


def new_figure(height: float = 5.6) -> Figure:
    """Return an empty figure.

    Args:
        height: Of the figure [inch].

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require("figures", "figures")
    from matplotlib.figure import Figure

    return Figure(figsize=(9.6, height), dpi=DPI)
