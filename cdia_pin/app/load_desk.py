"""`LoadDesk`: the form of the first step, and how a robot and a log are read from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from cdia_pin.app import picture
from cdia_pin.app.dropped import place_meshes, sort_dropped
from cdia_pin.app.form import Form, gain_text
from cdia_pin.app.inputs import Inputs, Request, read_model
from cdia_pin.app.log_columns import LogColumns, as_guessed, columns_of
from cdia_pin.app.runner import Runner
from cdia_pin.app.session import Session
from cdia_pin.dynamics import Dynamics
from cdia_pin.errors import CdiaError, LogError
from cdia_pin.logs.missing_columns import MissingColumnsError
from cdia_pin.progress import Progress
from cdia_pin.viewers.scene import Scene, SceneDocument, TimelineDocument

FIELDS = ("robot", "log", "mapping", "episode")  # marks of a fault that is of no cell


@dataclass(frozen=True)
class Loaded:
    """A session that was loaded, and what draws it."""

    session: Session
    scene: SceneDocument
    timeline: TimelineDocument


@dataclass(frozen=True)
class Unmapped:
    """A log that could not be read.

    Attributes:
        why: What is wrong with it.
        columns: What its columns hold; None if that is not known either.
        guessed: How to read it by a guess of what columns of unknown names hold; None without one.
    """

    why: str
    columns: LogColumns | None
    guessed: Request | None = None


class LoadDesk:
    """The form, what it was filled with, and what is wrong with it.

    Args:
        runner: Runs the jobs.

    Attributes:
        form: Its texts and marks.
        is_open: Whether it is shown.
        arm: The robot that was read last, whose joints the form names; None before.
        columns: What the columns of a log hold that could not be read; None where there is no such log.
        faults: What is wrong, by the marks of the fields; ``mapping`` is the table of joints.
    """

    def __init__(self, runner: Runner) -> None:
        self._runner = runner
        self.form, self.is_open = Form(), True
        self.arm: Dynamics | None = None
        self.columns: LogColumns | None = None
        self.faults: dict[str, str] = {}
        self._tried = Request("", Path())  # last

    @property
    def cell_faults(self) -> dict[str, str]:
        """What is wrong in cells of the table of joints, by their marks."""
        return {mark: sentence for mark, sentence in self.faults.items() if mark not in FIELDS}

    def check(self) -> bool:
        """Tell whether the form can be read; if not, say why."""
        self.faults = self.form.faults()
        if self.faults:
            self._runner.refuse("; ".join(self.faults.values()))
        return not self.faults

    async def read(self, asked: Request, show: Callable[[SceneDocument], None]) -> Loaded | None:
        """Read a robot, then a log.

        Args:
            asked: Robot, log and how to read it.
            show: Called with the arm, before the log is read.

        Returns:
            The session; None if something cannot be used: the form is then open, and says what.
        """
        asked = _without_what_was_of_others(asked, self._tried)
        self.form.take(asked)
        self.faults, self.columns = {}, None
        read = await self._runner.run("Reading the robot", lambda tell: _read_arm(asked, tell))
        if read is None or isinstance(read, str):
            self._refuse("robot", read or "")
            return None
        arm, scene = read
        self.arm, self._tried = arm, asked
        self.form.keep(arm.robot.joints)
        asked = self.form.request()  # without rows of another robot
        show(scene)
        if asked.log == Path():
            self._runner.say(f"{arm.robot.name} is read: now give its log.")
            self.is_open = True
            return None

        def work(tell: Progress) -> Loaded | Unmapped:
            try:
                inputs = Inputs.load(asked, tell, arm)
            except MissingColumnsError as error:
                columns = columns_of(asked, arm.robot.joints, error.guesses)
                return Unmapped(error.missing, columns, as_guessed(asked, error.guesses, arm.robot))
            except LogError as error:
                return Unmapped(str(error), columns_of(asked, arm.robot.joints))
            session = Session.of(inputs, tell)
            return Loaded(session, scene, picture.timeline(session))

        done = await self._runner.run("Loading", work)
        if isinstance(done, Unmapped):
            self._offer(done, arm)
            if done.columns is None:
                self._refuse("log", _for_people(done.why))
            else:
                self._refuse("mapping", _for_people(done.why))
                self._runner.refuse(
                    f"{asked.name or asked.log.name} is not read yet: see names, units and drive gains."
                )
            return None
        if done is not None:
            self.is_open = False
        return done

    def take(self, folder: Path) -> Form:
        """Fill the form with files that were dropped.

        Args:
            folder: That holds them.

        Returns:
            The form.

        Raises:
            CdiaError: If they cannot be used.
        """
        found = sort_dropped(folder)
        form = self.form
        if found.robot is not None:
            place_meshes(found.robot, found.meshes)
            form.robot = form.dropped_as(found.robot)
        elif found.meshes:
            urdf = form.dropped.get(form.robot)
            if urdf is None:
                raise CdiaError("meshes alone were dropped: drop the URDF with them, or before them")
            place_meshes(urdf, found.meshes)
        if found.log is not None:
            form.log = form.dropped_as(found.log)
        if found.model is not None:
            form.model = found.model
        joints = found.gains if self.arm is None or found.robot is not None else self.arm.robot.joints
        form.fill("gain", {joint: gain_text(gain) for joint, gain in found.gains.items() if joint in joints})
        return form

    def _offer(self, log: Unmapped, arm: Dynamics) -> None:
        """Propose columns of a log of unknown names, and names of a log whose joints are not the robot's."""
        self.columns = log.columns
        if log.guessed is not None:
            self.form.take(log.guessed)
        if log.columns is not None:
            for joint, label in log.columns.proposed(arm.robot.joints).items():
                if not self.form.cell(joint, "label"):
                    self.form.note(joint, "label", label)

    def _refuse(self, field: str, why: str) -> None:
        """Leave the form open, with a fault at one of its fields if there is one."""
        self.is_open = True
        if why:
            self.faults = {field: why}
            self._runner.refuse(why)


def _for_people(why: str) -> str:
    """Return a message without what to type on a command line, if more is said; the form is there instead."""
    return "; ".join(part for part in why.split("; ") if "--" not in part) or why


def _without_what_was_of_others(asked: Request, before: Request) -> Request:
    """Return a request without the model of the robot before, and without the columns of the log before."""
    if asked.model == before.model and asked.robot != before.robot:
        asked = replace(asked, model=None)
    if before.log in {Path(), asked.log}:
        return asked
    format_ = None if asked.format == before.format else asked.format
    episode = None if asked.episode == before.episode else asked.episode
    return replace(asked, columns={}, format=format_, episode=episode)


def _read_arm(asked: Request, tell: Progress) -> tuple[Dynamics, SceneDocument] | str:
    try:
        model = read_model(asked)
    except CdiaError as error:
        return str(error)
    tell("drawing the arm", 0.5)
    return model, Scene.of(model.robot).to_dict()
