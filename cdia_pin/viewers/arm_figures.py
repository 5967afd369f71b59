"""Figures of the study of accommodation on several arms, as PNG: one for each arm and fault."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.viewers.study_figures import INK, LINE, POINTS, STYLES, Picture, new_figure, scale
from cdia_pin.viewers.words import short_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cdia_pin.campaigns.arm_study import ArmCase

COLUMNS = 2


def arm_pictures(cases: Sequence[ArmCase]) -> Iterator[Picture]:
    """Yield the tracking errors of every case.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    for case in cases:
        words = "".join(c if c.isalnum() else " " for c in case.name).split()
        yield Picture(
            f"{case.arm}_{'_'.join(words)}",
            f"{case.arm}: {case.name}",
            "q − q_d of each joint; dotted upright lines: a fault begins. Where a scale is logarithmic, it is linear "
            "up to three times the healthy error.",
            _panels(case),
        )


def _panels(case: ArmCase) -> bytes:
    robot = case.compared.loop.robot
    rows = -(-robot.n // COLUMNS)
    figure = new_figure(1.0 + 1.75 * rows)
    panels: list[Axes] = list(np.ravel(figure.subplots(rows, COLUMNS, sharex=True, squeeze=False)))
    runs = {
        "healthy": case.compared.healthy,
        "faulty": case.compared.faulty,
        "accommodated": case.compared.monitored,
    }
    errors = {name: (r.log.time, 1e3 * r.error) for name, r in runs.items() if r is not None}
    healthy = errors["healthy"][1]
    linear = 3.0 * np.abs(healthy).max(axis=0)
    most = np.max([np.abs(e).max(axis=0) for _, e in errors.values()], axis=0)
    onsets = {float(getattr(t.profile, "start", 0.0)) for t in case.faults}
    short = short_names(robot.joints)
    for j, joint in enumerate(robot.joints):
        axes = panels[j]
        for name, (time, error) in errors.items():
            thin = max(len(time) // POINTS, 1)
            axes.plot(time[::thin], error[::thin, j], label=name, **STYLES[name])  # type: ignore[arg-type]
        for onset in onsets:
            axes.axvline(onset, color=INK, linewidth=0.9, linestyle=":", zorder=1)
        axes.set_title(short[joint], fontsize=10, loc="left", color=INK)
        axes.set_ylabel(f"[{'mm' if robot.is_prismatic[j] else 'mrad'}]", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(color=LINE, linewidth=0.6)
        axes.set_axisbelow(True)
        axes.margins(x=0)
        axes.spines[["top", "right"]].set_visible(False)
        scale(axes, j, linear, most)
        if j >= robot.n - COLUMNS:
            axes.set_xlabel("time [s]", fontsize=9)
            axes.tick_params(labelbottom=True)
    for axes in panels[robot.n :]:
        axes.set_visible(False)
    handles, labels = panels[0].get_legend_handles_labels()
    height = figure.get_figheight()
    figure.subplots_adjust(
        left=0.085, right=0.985, bottom=0.5 / height, top=1 - 0.55 / height, wspace=0.2, hspace=0.3
    )
    figure.legend(handles, labels, loc="upper center", ncols=len(labels), fontsize=9, frameon=False)
    out = io.BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()
