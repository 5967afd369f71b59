"""The first page: from a log to the missing effects, step by step beside the arm."""

from __future__ import annotations

import re
from collections.abc import Callable

from nicegui import context, ui

from cdia_pin.app import picture
from cdia_pin.app.drop_route import ADDRESS
from cdia_pin.app.dropped import USEFUL
from cdia_pin.app.elements import ArmElement, ChartsElement, DropElement
from cdia_pin.app.load_step import load_step
from cdia_pin.app.missing_step import missing_step
from cdia_pin.app.next_motion import Doubt
from cdia_pin.app.parts import PageStep, button, folded, node
from cdia_pin.app.result_steps import check_step, compare_step, export_step
from cdia_pin.app.runner_bar import RunnerBar
from cdia_pin.app.session import Session
from cdia_pin.app.tiles import tiles
from cdia_pin.app.workbench import Workbench
from cdia_pin.fault_report import fault_sentence
from cdia_pin.phrases import NO_BREAK, counted

STEPS = {
    "load": "Load a robot and a log",
    "check": "Check the log",
    "compare": "Compare",
    "missing": "Missing effects",
    "export": "Export",
}


class FindPage:
    """One tab: the elements that show a workbench. What is done goes to the workbench, which tells its pages.

    Args:
        bench: What is shown.
        key: Of the bench, for addresses.
        leave: Called when the tab has gone.
    """

    def __init__(self, bench: Workbench, key: str, leave: Callable[[], None]) -> None:
        self.bench, self._leave = bench, leave
        context.client.on_delete(self._close)  # also of a page that cannot be built
        context.client.on_exception(self._crashed)
        self._build(key)
        self.show()
        self.draw_arm()
        bench.pages.append(self)

    def _build(self, key: str) -> None:
        bench = self.bench
        DropElement(
            ADDRESS + key,
            USEFUL,
            lambda drop: bench.take_dropped(str(drop)),
            bench.runner.refuse,
        )
        with node("div", classes="page"):
            with node("div", classes="steps"):
                RunnerBar(bench.runner)
                self._steps = {
                    mark: PageStep(k, title, mark) for k, (mark, title) in enumerate(STEPS.items(), 1)
                }
            with node("div", classes="stage") as self._stage:
                self._arm = ArmElement(self.choose)
                self._arm.props["data-mark"] = "arm"
                self._tiles = node("div", classes="tiles", role="group", aria_label="Joints")
                self._charts = ChartsElement()
                self._charts.props["data-mark"] = "charts"

    def _close(self) -> None:
        if self in self.bench.pages:
            self.bench.pages.remove(self)
        self._leave()

    def _crashed(self, error: Exception) -> None:
        """Say what has failed on the page itself, and a way on."""
        fault = fault_sentence(error, "cdia app: the page")
        self.bench.runner.refuse(f"{fault}. Load this page again: the session is kept.")

    # ------------------------------------------------------------- what can be done

    def choose(self, joint: str | None) -> None:
        """Show a joint; a click beside the arm chooses none.

        Args:
            joint: Name.
        """
        self.bench.choose(joint)

    async def export(self, what: str) -> None:
        """Download a file.

        Args:
            what: A key of `workbench.FILES`.
        """
        self._download(await self.bench.export(what))

    async def design(self, doubt: Doubt) -> None:
        """Download a motion that distinguishes two effects.

        Args:
            doubt: The two effects.
        """
        self._download(await self.bench.design(doubt))

    def _download(self, made: tuple[bytes, str] | None) -> None:
        if made is not None:
            with self._stage:
                ui.download.content(*made)

    # ------------------------------------------------------------- how it is shown

    def draw_arm(self) -> None:
        """Draw the arm anew, and its motion."""
        bench = self.bench
        state = "waiting" if bench.scene is None else "open" if bench.session is not None else "rest"
        self._stage.props["data-state"] = state
        self._stage.update()
        if bench.scene is not None:
            self._arm.draw(bench.scene, bench.timeline["stages"] if bench.timeline else [])
        self.draw_motion()

    def draw_motion(self) -> None:
        """Show the motion of the log, coloured anew."""
        timeline = self.bench.timeline
        if timeline is not None:
            self._arm.play(timeline, len(timeline.get("variants", ())))
            self.draw_joint()

    def draw_joint(self) -> None:
        """Show the joint that is chosen: its tile, its link and its charts."""
        bench = self.bench
        if bench.session is None:
            return
        self._arm.select(bench.joint)
        self._tiles.clear()
        with self._tiles:
            tiles(bench.session, bench.joint, bench.choose)
        self._charts.draw(picture.joint(bench.session, bench.joint))

    def focus(self, mark: str) -> None:
        """Move the keyboard to a step, for the button that had it is gone.

        Args:
            mark: Of the step.
        """
        self._steps[mark].focus()

    def show(self, *marks: str) -> None:
        """Fill steps anew.

        Args:
            *marks: Which ones; all if none is given.
        """
        bench = self.bench
        if not marks or "load" in marks:
            with self._steps["load"].filling("open" if bench.desk.is_open else "done"):
                if bench.session is not None and not bench.desk.is_open:
                    self._loaded(bench.session)
                else:
                    load_step(bench)
        views: dict[str, Callable[[Session], None]] = {
            "check": lambda s: check_step(s.inputs.check, bench),
            "compare": lambda s: compare_step(s, bench),
            "missing": lambda s: missing_step(s, bench, self.design),
            "export": lambda s: export_step(s, self.export),
        }
        for mark, view in views.items():
            if marks and mark not in marks:
                continue
            with self._steps[mark].filling("waiting" if bench.session is None else "open"):
                if bench.session is not None:
                    view(bench.session)

    def _loaded(self, session: Session) -> None:
        """Say in a line what is loaded."""
        inputs = session.inputs
        log = inputs.log
        with node("p", data_mark="loaded"):
            node("b", inputs.robot.name)
            node("span", f", {counted(inputs.robot.n, 'joint')} · ")
            node("b", inputs.request.name or log.source)
            size = f", {len(log.time):,} samples, {log.duration:.4g} s at {log.rate:.4g} Hz"
            node("span", re.sub(r"(?<=\d) (?=\w)", NO_BREAK, size), "soft")
        if said := inputs.robot.warnings:
            with folded(
                f"{len(said)} remarks on the URDF" if len(said) > 1 else "A remark on the URDF",
                mark="remarks",
            ):
                for sentence in said:
                    node("p", sentence, "soft")
        button("Change", self.bench.open_form, mark="change", classes="quiet")
