"""The first page: from a log to the missing effects, step by step beside the arm."""

from __future__ import annotations

import re
from collections.abc import Callable

from nicegui import context, ui

from cdia_pin.app import exports, picture
from cdia_pin.app.elements import ArmElement, ChartsElement
from cdia_pin.app.inputs import Request
from cdia_pin.app.load_step import LoadStep
from cdia_pin.app.missing_step import missing_step
from cdia_pin.app.next_motion import Doubt, designed
from cdia_pin.app.parts import PageStep, button, node
from cdia_pin.app.result_steps import check_step, compare_step, export_step
from cdia_pin.app.runner import Runner
from cdia_pin.app.session import Session
from cdia_pin.app.tiles import tiles
from cdia_pin.phrases import NO_BREAK
from cdia_pin.progress import Progress
from cdia_pin.viewers.scene import Scene, SceneDocument, TimelineDocument
from cdia_pin.viewers.words import percent

FILES: dict[str, tuple[Callable[[Session], bytes], str]] = {
    "model": (exports.model_file, "model.json"),
    "urdf": (exports.urdf_file, "corrected.urdf"),
    "report": (exports.report_file, "report.html"),
    "python": (exports.python_file, "same.py"),
}


class FindPage:
    """One tab: its session, the joint that is chosen, and the elements that show them.

    Args:
        start: What to load at once; None for an empty form.
    """

    def __init__(self, start: Request | None = None) -> None:
        self.session: Session | None = None
        self.joint = ""
        self._searching = False
        self._build()
        self._form_open = True
        self._show()
        context.client.on_delete(self._close)
        if start is not None:
            self._load_step.form.take(start)
            ui.timer(0.05, lambda: self.load(start), once=True)

    def _build(self) -> None:
        with node("div", classes="page"):
            with node("div", classes="steps"):
                self._runner = Runner()
                self._load_step = LoadStep(self.load, self._refuse)
                self._steps = {
                    mark: PageStep(k, title, mark)
                    for k, (mark, title) in enumerate(
                        [
                            ("load", "Load a robot and a log"),
                            ("check", "Check the log"),
                            ("compare", "Compare"),
                            ("missing", "Missing effects"),
                            ("export", "Export"),
                        ],
                        1,
                    )
                }
            with node("div", classes="stage") as self._stage:
                self._arm = ArmElement(self._pick)
                self._arm.props["data-mark"] = "arm"
                self._tiles = node("div", classes="tiles", role="group", aria_label="Joints")
                self._charts = ChartsElement()
                self._charts.props["data-mark"] = "charts"

    def _close(self) -> None:
        self._runner.cancel()
        self._load_step.close()

    # ------------------------------------------------------------- what can be done

    async def load(self, asked: Request) -> None:
        """Load a robot and a log; if that fails, the present session stays.

        Args:
            asked: Robot, log and how to read it.
        """

        def work(tell: Progress) -> tuple[Session, SceneDocument, TimelineDocument]:
            session = Session.load(asked, tell)
            return session, Scene.of(session.inputs.robot).to_dict(), picture.timeline(session)

        done = await self._runner.run("Loading", work)
        if done is None:
            return
        session, scene, timeline = done
        self.session, self._form_open = session, False
        self._load_step.form.take(asked)
        worst = int(session.present.comparison.relative_rms.argmax())
        self.joint = session.inputs.robot.joints[worst]
        self._arm.draw(scene, timeline["stages"])
        self._show_motion(timeline)
        self._show()
        said = f"Loaded {session.inputs.robot.name}: the error is {percent(session.present.error)} of the torque."
        mend = session.inputs.check.mend
        self._runner.say(f"{said} There is no search yet. {mend}." if mend else said)
        if not mend:
            await self.search()

    async def convert(self, option: str) -> None:
        """Load the log again with a conversion.

        Args:
            option: Such as ``angle=deg``.
        """
        if self.session is not None:
            await self.load(self.session.inputs.request.converted(option))

    async def search(self) -> None:
        """Search for the effects that the present model lacks."""
        asked = self.session
        if asked is None:
            return
        self._searching = True
        self._show("missing")
        done = await self._runner.run("Searching for missing effects", asked.search)
        self._searching = self._runner.job is not None
        if done is not None and self.session is asked:
            self.session = done
            mend = asked.inputs.check.mend
            self._runner.say("The search has ended." + (f" Its result is doubtful. {mend}." if mend else ""))
        self._show("missing")

    async def preview(self, text: str) -> None:
        """Show the error with one more effect.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """
        await self._step(f"Fitting {text}", lambda s, tell: s.with_preview(text, tell), "missing")

    async def add(self, text: str) -> None:
        """Add an effect, then search again.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """
        if await self._step(f"Adding {text}", lambda s, tell: s.add(text, tell), "missing"):
            await self.search()

    async def add_found(self) -> None:
        """Add all effects of the search, then search again."""
        if await self._step("Adding", lambda s, tell: s.add_found(), "missing"):
            await self.search()

    async def drop_preview(self) -> None:
        """Forget the preview."""
        await self._step("Discarding the preview", lambda s, tell: s.without_preview(), "missing")

    async def goto(self, at: int) -> None:
        """Return to a model of the history.

        Args:
            at: Its index.
        """
        done = await self._step("Returning", lambda s, tell: s.goto(at), "missing")
        if done and self.session is not None and self.session.found is None:
            await self.search()

    def choose(self, joint: str | None) -> None:
        """Show a joint: its tile, its link and its charts.

        Args:
            joint: Name.
        """
        if self.session is None or joint not in self.session.inputs.robot.joints:
            return
        self.joint = joint
        self._arm.select(joint)
        self._show_tiles()
        self._charts.draw(picture.joint(self.session, joint))

    async def export(self, what: str) -> None:
        """Download a file.

        Args:
            what: A key of `FILES`.
        """
        session = self.session
        if session is None:
            return
        write, name = FILES[what]
        content = await self._runner.run(f"Writing {name}", lambda tell: write(session))
        if content is not None:
            with self._stage:
                ui.download.content(content, name)
            self._runner.say(f"{name} is downloaded.")

    async def design(self, doubt: Doubt) -> None:
        """Design a motion that distinguishes two effects, and download it.

        Args:
            doubt: The two effects.
        """
        session = self.session
        if session is None:
            return
        done = await self._runner.run("Designing a motion", lambda tell: designed(session, doubt, tell))
        if done is not None:
            content, gain = done
            with self._stage:
                ui.download.content(content, "motion.csv")
            self._runner.say(f"motion.csv is downloaded: {gain}")

    # ------------------------------------------------------------- how it is shown

    async def _step(self, sentence: str, step: Callable[[Session, Progress], Session], mark: str) -> bool:
        """Take a step of the session beside the page; return whether it was taken."""
        asked = self.session
        if asked is None:
            return False

        def work(tell: Progress) -> tuple[Session, TimelineDocument]:
            session = step(asked, tell)
            return session, picture.timeline(session)

        self._searching = False
        done = await self._runner.run(sentence, work)
        if done is None:
            self._show("missing")
            return False
        self.session, timeline = done
        self._show_motion(timeline)
        self._show("check", "compare", "missing", "export")
        self._steps[mark].focus()
        shown = self.session.preview or self.session.present
        said = "With the preview the error would be" if self.session.preview else "The error is"
        self._runner.say(f"{said} {percent(shown.error)} of the torque.")
        return True

    def _pick(self, joint: str | None) -> None:
        if joint is not None:
            self.choose(joint)

    def _refuse(self, sentence: str) -> None:
        self._runner.wrong.text = sentence

    def _show_motion(self, timeline: TimelineDocument) -> None:
        self._arm.play(timeline, len(timeline.get("variants", ())))
        self.choose(self.joint)

    def _show_tiles(self) -> None:
        self._tiles.clear()
        with self._tiles:
            if self.session is not None:
                tiles(self.session, self.joint, self.choose)

    def _show(self, *marks: str) -> None:
        """Fill steps anew; all of them if none is named."""
        session = self.session
        self._stage.props["data-state"] = "waiting" if session is None else "open"
        self._stage.update()
        if not marks or "load" in marks:
            with self._steps["load"].filling("open" if self._form_open else "done"):
                self._load_summary() if session is not None and not self._form_open else self._load_step.show(
                    session.inputs.robot if session else None
                )
        views: dict[str, Callable[[Session], None]] = {
            "check": lambda s: check_step(s.inputs.check, self),
            "compare": lambda s: compare_step(s, self),
            "missing": lambda s: missing_step(s, self, self._searching),
            "export": lambda s: export_step(s, self),
        }
        for mark, view in views.items():
            if marks and mark not in marks:
                continue
            with self._steps[mark].filling("waiting" if session is None else "open"):
                if session is not None:
                    view(session)

    def _load_summary(self) -> None:
        assert self.session is not None
        inputs = self.session.inputs
        log = inputs.log
        with node("p", data_mark="loaded"):
            node("b", inputs.robot.name)
            node("span", f", {inputs.robot.n} joints · ")
            node("b", inputs.request.name or log.source)
            size = f", {len(log.time):,} samples, {log.duration:.4g} s at {log.rate:.4g} Hz"
            node("span", re.sub(r"(?<=\d) (?=\w)", NO_BREAK, size), "soft")
        for sentence in inputs.robot.warnings:
            node("p", sentence, "soft")
        button("Change", self._open_form, mark="change", classes="quiet")

    def _open_form(self) -> None:
        self._form_open = True
        self._show("load")
