"""The running job on a page: a bar, sentences and a button to cancel."""

from __future__ import annotations

from nicegui import ui

from cdia_pin.app.parts import button, node
from cdia_pin.app.runner import Runner

LOOK = 0.1  # [s], between looks at the runner


class RunnerBar:
    """Shows a runner at the top of a page, wherever the page is scrolled to.

    Args:
        runner: The runner.
    """

    def __init__(self, runner: Runner) -> None:
        self._runner = runner
        with node("div", classes="notices"):
            self._said = node("p", classes="said", role="status", aria_live="polite", data_mark="said")
            self._wrong = node("p", classes="wrong", role="alert", data_mark="wrong")
            with node("div", classes="running", data_mark="running", data_busy="no") as self._bar:
                self._doing = node("span")
                self._share = node("progress", value=0, max=1, aria_label="progress")
                button("Cancel", runner.cancel, mark="cancel", classes="quiet")
        self.look()
        ui.timer(LOOK, self.look)

    def look(self) -> None:
        """Show what the runner says now; what has not changed is not sent again."""
        runner = self._runner
        for place, text in (
            (self._said, runner.said),
            (self._wrong, runner.wrong),
            (self._doing, runner.doing),
        ):
            if place.text != text:
                place.text = text
        busy = "yes" if runner.job is not None else "no"
        share = round(runner.job.share, 3) if runner.job is not None else 0
        if self._share.props["value"] != share:
            self._share.props["value"] = share
            self._share.update()
        if self._bar.props["data-busy"] != busy:
            self._bar.props["data-busy"] = busy
            self._bar.update()
