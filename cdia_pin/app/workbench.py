"""`Workbench`: a session with its form, its jobs and what is chosen, on the server; pages come and go."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from cdia_pin.app import exports, picture
from cdia_pin.app.advice import advice_words
from cdia_pin.app.bench_page import BenchPage
from cdia_pin.app.drops import Drops
from cdia_pin.app.form import Form
from cdia_pin.app.inputs import Request
from cdia_pin.app.load_desk import LoadDesk
from cdia_pin.app.next_motion import Doubt, designed
from cdia_pin.app.runner import Runner
from cdia_pin.app.session import Session
from cdia_pin.errors import CdiaError
from cdia_pin.progress import Progress
from cdia_pin.viewers.scene import SceneDocument, TimelineDocument
from cdia_pin.viewers.words import percent

FILES: dict[str, tuple[Callable[[Session], bytes], str]] = {
    "model": (exports.model_file, "model.json"),
    "urdf": (exports.urdf_file, "corrected.urdf"),
    "report": (exports.report_file, "report.html"),
    "python": (exports.python_file, "same.py"),
}


class Workbench:
    """A session and all that a page needs to show it again.

    Args:
        folder: For files that are dropped; removed at the end.

    Attributes:
        session: What was loaded; None before.
        desk: The form of the first step.
        scene: The arm to draw; None before.
        timeline: Its motion; None before.
        joint: The joint that is chosen.
        typed: The user's own effect, as typed.
        own_fault: What is wrong with it.
        searching: Whether a search runs.
        runner: Runs the jobs.
        pages: Those that show this workbench.
        folder: For files that are dropped.
        drops: Those files.
    """

    def __init__(self, folder: Path) -> None:
        self.session: Session | None = None
        self.runner = Runner()
        self.desk = LoadDesk(self.runner)
        self.scene: SceneDocument | None = None
        self.timeline: TimelineDocument | None = None
        self.joint, self.typed, self.own_fault = "", "", ""
        self.searching = False
        self.pages: list[BenchPage] = []
        self.folder, self.drops = folder, Drops(folder)

    def close(self) -> None:
        """Cancel what runs, and remove what was dropped."""
        self.runner.cancel()
        shutil.rmtree(self.folder, ignore_errors=True)

    # ------------------------------------------------------------- loading

    async def submit(self) -> None:
        """Load what the form asks for."""
        if self.desk.check():
            await self.load(self.desk.form.request())
        else:
            self._show("load")

    async def load(self, asked: Request) -> None:
        """Load a robot and a log; if that fails, the present session stays.

        Args:
            asked: Robot, log and how to read it.
        """
        loaded = await self.desk.read(asked, self._draw_at_rest)
        if loaded is None:
            self._show("load")
            self._tell(lambda page: page.focus("load"))
            return
        session = self.session = loaded.session
        self.scene, self.timeline = loaded.scene, loaded.timeline
        self.typed = self.own_fault = ""
        worst = session.present.comparison.worst
        self.joint = session.inputs.robot.joints[worst]
        self._tell(lambda page: page.draw_arm())
        self._show()
        said = f"Loaded {session.inputs.robot.name}: the error is {percent(session.present.error)} of the torque."
        mend = advice_words(session.inputs.check.mend)
        self.runner.say(f"{said} There is no search yet. {mend}." if mend else said)
        if not mend:
            await self.search()

    async def take_dropped(self, drop: str) -> None:
        """Fill the form with files that were dropped, and load what can be loaded.

        Args:
            drop: Name of the drop, as its page gives it.
        """
        form = await self.runner.run("Looking at the files", lambda tell: self._look_at(drop))
        self.open_form()
        if form is not None and form.robot:
            await self.submit()

    def _look_at(self, drop: str) -> Form:
        try:
            return self.desk.take(self.drops.folder(drop))
        except CdiaError:
            self.drops.forget(drop)
            raise

    def remove_model(self) -> None:
        """Take the saved model out of the form."""
        self.desk.form.model = None
        self._show("load")

    async def convert(self, option: str) -> None:
        """Load the log again with a conversion.

        Args:
            option: Such as ``angle=deg``.
        """
        if self.session is not None:
            await self.load(self.session.inputs.request.converted(option))

    async def take_robot(self, robot: str) -> None:
        """Load the log again with another robot.

        Args:
            robot: Name of the catalogue.
        """
        if self.session is not None:
            await self.load(replace(self.session.inputs.request, robot=robot, robot_name="", model=None))

    def open_form(self) -> None:
        """Show the form again."""
        self.desk.is_open = True
        self._show("load")

    def _draw_at_rest(self, scene: SceneDocument) -> None:
        """Show an arm whose log is not read yet, where no other is shown."""
        if self.session is None:
            self.scene = scene
            self._tell(lambda page: page.draw_arm())
            self._show("load")

    # ------------------------------------------------------------- the missing effects

    async def search(self) -> None:
        """Search for the effects that the present model lacks."""
        asked = self.session
        if asked is None:
            return
        self.searching = True
        self._show("missing")
        done = await self.runner.run("Searching for missing effects", asked.search)
        self.searching = self.runner.job is not None
        if done is not None and self.session is asked:
            self.session = done
            mend = advice_words(asked.inputs.check.mend)
            self.runner.say("The search has ended." + (f" Its result is doubtful. {mend}." if mend else ""))
        self._show("missing")

    async def preview(self, text: str) -> None:
        """Show the error with one more effect.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """
        await self._step(f"Fitting {text}", lambda s, tell: s.with_preview(text, tell), effect=text)

    async def add(self, text: str) -> None:
        """Add an effect, then search again.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """
        if await self._step(f"Adding {text}", lambda s, tell: s.add(text, tell), effect=text):
            await self.search()

    async def add_found(self) -> None:
        """Add all effects of the search, then search again."""
        if await self._step("Adding", lambda s, tell: s.add_found()):
            await self.search()

    async def drop_preview(self) -> None:
        """Forget the preview."""
        await self._step("Discarding the preview", lambda s, tell: s.without_preview())

    async def goto(self, at: int) -> None:
        """Return to a model of the history.

        Args:
            at: Its index.
        """
        done = await self._step("Returning", lambda s, tell: s.goto(at))
        if done and self.session is not None and self.session.found is None:
            await self.search()

    async def _step(
        self, sentence: str, step: Callable[[Session, Progress], Session], effect: str = ""
    ) -> bool:
        """Take a step of the session, with the effect that it fits; return whether it was taken."""
        asked = self.session
        if asked is None:
            return False

        def work(tell: Progress) -> tuple[Session, TimelineDocument]:
            session = step(asked, tell)
            return session, picture.timeline(session)

        self.searching, self.own_fault = False, ""
        done = await self.runner.run(sentence, work)
        if done is None:
            if effect and effect == self.typed:
                self.own_fault = self.runner.wrong
            self._show("missing")
            return False
        self.session, self.timeline = done
        self.typed = ""
        self._tell(lambda page: page.draw_motion())
        self._show("check", "compare", "missing", "export")
        self._tell(lambda page: page.focus("missing"))
        shown = self.session.preview or self.session.present
        said = "With the preview the error would be" if self.session.preview else "The error is"
        self.runner.say(f"{said} {percent(shown.error)} of the torque.")
        return True

    # ------------------------------------------------------------- what is shown and handed out

    def type_own(self, text: str) -> None:
        """Take note of the user's own effect.

        Args:
            text: As typed.
        """
        self.typed = text.strip()

    def choose(self, joint: str | None) -> None:
        """Show a joint: its tile, its link and its charts.

        Args:
            joint: Name.
        """
        if self.session is not None and joint in self.session.inputs.robot.joints:
            self.joint = joint
            self._tell(lambda page: page.draw_joint())

    async def export(self, what: str) -> tuple[bytes, str] | None:
        """Return a file and its name; None if it cannot be made.

        Args:
            what: A key of `FILES`.
        """
        session = self.session
        if session is None:
            return None
        write, name = FILES[what]
        content = await self.runner.run(f"Writing {name}", lambda tell: write(session))
        if content is None:
            return None
        self.runner.say(f"{name} is downloaded.")
        return content, name

    async def design(self, doubt: Doubt) -> tuple[bytes, str] | None:
        """Return a motion that distinguishes two effects, and its name; None if there is none.

        Args:
            doubt: The two effects.
        """
        session = self.session
        if session is None:
            return None
        done = await self.runner.run("Designing a motion", lambda tell: designed(session, doubt, tell))
        if done is None:
            return None
        content, gain = done
        self.runner.say(f"motion.csv is downloaded: {gain}")
        return content, "motion.csv"

    # ------------------------------------------------------------- pages

    def _show(self, *marks: str) -> None:
        self._tell(lambda page: page.show(*marks))

    def _tell(self, what: Callable[[BenchPage], None]) -> None:
        for page in list(self.pages):
            what(page)
