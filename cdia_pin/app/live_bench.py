"""`LiveBench`: an arm that moves, with its form and what is chosen, on the server; pages come and go."""

from __future__ import annotations

from pathlib import Path

from cdia_pin.app.live_run import LiveRun
from cdia_pin.app.live_sources import Source, replayed, simulated
from cdia_pin.app.runner import Runner
from cdia_pin.effects import Term
from cdia_pin.progress import Progress
from cdia_pin.viewers.event_words import fault_words
from cdia_pin.viewers.scene import Scene, SceneDocument


class LiveBench:
    """A run and all that a page needs to show it again.

    Attributes:
        form: What is asked for.
        run: What moves, or has moved last; None before.
        scene: Its arm to draw; None before.
        runner: Prepares it, and says what has happened.
    """

    def __init__(self) -> None:
        self.form: dict[str, str | bool] = {
            "what": "simulate",
            "robot": "ur5",
            "log": "",
            "faults": "",
            "accommodate": True,
        }
        self.run: LiveRun | None = None
        self.scene: SceneDocument | None = None
        self.runner = Runner()
        self._chosen = ""  # the joint that the user chose; until then the last event chooses
        self._failed: LiveRun | None = None  # the run whose failure is said
        self._pages = 0

    def close(self) -> None:
        """Stop what moves or is prepared."""
        self.runner.cancel()
        if self.run is not None:
            self.run.stop()

    @property
    def moves(self) -> bool:
        """Whether there is a run that has not ended; it may be paused."""
        return self.run is not None and not self.run.ended

    @property
    def joint(self) -> str:
        """The joint that is shown; empty before a run."""
        if self.run is None:
            return ""
        if not self._chosen and self.run.events:
            return self.run.events[-1].joints[0]
        return self._chosen or self.run.source.robot.joints[0]

    # ------------------------------------------------------------- pages

    def arrive(self) -> None:
        """Note that a page shows the arm."""
        self._pages += 1

    def leave(self) -> None:
        """Note that a page has gone; nothing moves that nobody sees."""
        self._pages -= 1
        if self._pages == 0 and self.run is not None and self.moves and not self.run.paused:
            self.run.pause(True)
            self.runner.say("Paused, because no page has shown the arm any more.")

    def look(self) -> None:
        """Say once why a run has failed."""
        run = self.run
        if run is not None and run.ended and run.error and run is not self._failed:
            self._failed = run
            self.runner.refuse(run.error)

    # ------------------------------------------------------------- what can be done

    async def begin(self) -> None:
        """Prepare what the form asks for, and let it move; if that fails, what moves goes on."""
        asked = dict(self.form)
        replay = asked["what"] == "replay"

        def work(tell: Progress) -> tuple[Source, SceneDocument]:
            robot = str(asked["robot"]).strip()
            if replay:
                source = replayed(robot, Path(str(asked["log"]).strip()).expanduser(), tell)
            else:
                lines = [line.strip() for line in str(asked["faults"]).splitlines() if line.strip()]
                source = simulated(robot, lines, bool(asked["accommodate"]), tell)
            tell("drawing the arm", 0.97)
            return source, Scene.of(source.robot).to_dict(source.reach[0])

        done = await self.runner.run("Preparing", work)
        if done is None:
            return
        source, self.scene = done
        if self.run is not None:
            self.run.stop()
        self._chosen = ""
        self.run = LiveRun(source, replay=replay)
        self.runner.say(" ".join([f"{source.robot.name} moves.", *source.notes]))

    def end(self) -> None:
        """Stop what moves."""
        if self.run is not None:
            self.run.stop()
        self.runner.say("Stopped.")

    def pause(self) -> None:
        """Pause, or go on."""
        if self.run is not None:
            self.run.pause(not self.run.paused)

    def switch(self, fault: Term) -> None:
        """Switch a fault on or off.

        Args:
            fault: One of the source's.
        """
        if self.run is None:
            return
        acting = self.run.source.acting
        if fault in acting:
            acting.remove(fault)
        else:
            acting.add(fault)
        words = fault_words(fault, self.run.source.robot, joint=True)
        self.runner.say(f"{'On' if fault in acting else 'Off'}: {words}")

    def choose(self, joint: str | None) -> None:
        """Show a joint from now on; a click beside the arm changes nothing.

        Args:
            joint: Name.
        """
        self._chosen = joint or self._chosen
