"""The second page: faults are switched while an arm moves, or a log is monitored as it would have been live."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from nicegui import context, ui

from cdia_pin.app.elements import ArmElement, LiveElement
from cdia_pin.app.live_run import LiveRun
from cdia_pin.app.live_sources import Source, replayed, simulated
from cdia_pin.app.parts import PageStep, button, node
from cdia_pin.app.runner import Runner
from cdia_pin.app.runner_bar import RunnerBar
from cdia_pin.diagnosis import Event
from cdia_pin.diagnosis.event_history import MOST_EVENTS
from cdia_pin.diagnosis.sight import blind_joints
from cdia_pin.effects import Term
from cdia_pin.fault_report import fault_sentence
from cdia_pin.progress import Progress
from cdia_pin.robot import catalogue
from cdia_pin.viewers.event_words import event_rows, fault_words
from cdia_pin.viewers.scene import Frame, Scene, SceneDocument, monitor_stages
from cdia_pin.viewers.words import joint_units, short_names

LOOK = 0.1  # [s], between looks at what is new
WHAT = {"simulate": "Simulate", "replay": "Replay a log"}


class LivePage:
    """One tab: the moving arm, and the elements that show it."""

    def __init__(self) -> None:
        self._run: LiveRun | None = None
        self._form = {"what": "simulate", "robot": "ur5", "log": "", "faults": "", "accommodate": True}
        self._events: list[Event] = []
        self._chosen = False  # whether the user chose a joint; until then the last event does
        self._stages = [s.to_dict() for s in monitor_stages()]
        self._runner = Runner()
        with node("div", classes="page"):
            with node("div", classes="steps"):
                RunnerBar(self._runner)
                self._what = PageStep(1, "What moves", "what")
                self._faults = PageStep(2, "Faults", "faults")
                self._said = PageStep(3, "Events of the monitor", "events")
            with node("div", classes="stage", data_state="waiting") as self._stage:
                self._arm = ArmElement(self._choose)
                self._arm.props["data-mark"] = "arm"
                self._live = LiveElement(self._choose)
        self._show_form()
        with self._faults.filling("waiting"), self._said.filling("waiting"):
            pass
        ui.timer(LOOK, self._look)
        context.client.on_delete(self._close)
        context.client.on_exception(self._crashed)

    def _crashed(self, error: Exception) -> None:
        """Say what has failed on the page itself, and a way on."""
        self._runner.refuse(f"{fault_sentence(error, 'cdia app: the page')}. Begin anew.")

    def _close(self) -> None:
        self._runner.cancel()
        if self._run is not None:
            self._run.stop()

    # ------------------------------------------------------------- what can be done

    async def begin(self) -> None:
        """Prepare what the form asks for, and let it move."""
        asked = dict(self._form)

        def work(tell: Progress) -> tuple[Source, SceneDocument]:
            robot = str(asked["robot"]).strip()
            if asked["what"] == "replay":
                source = replayed(robot, Path(str(asked["log"]).strip()).expanduser(), tell)
            else:
                lines = [line.strip() for line in str(asked["faults"]).splitlines() if line.strip()]
                source = simulated(robot, lines, bool(asked["accommodate"]), tell)
            tell("drawing the arm", 0.97)
            return source, Scene.of(source.robot).to_dict(source.reach[0])

        done = await self._runner.run("Preparing", work)
        if done is None:
            return
        source, scene = done
        if self._run is not None:
            self._run.stop()
        self._events = []
        self._stage.props["data-state"] = "open"
        self._stage.update()
        robot = source.robot
        short = short_names(robot.joints)
        units = {j: joint_units(robot, j)["load"] for j in robot.joints}
        self._arm.draw(scene, self._stages, source.reach.tolist())
        blind = blind_joints(source.monitor.record["sight"])
        self._live.begin(
            [{"name": j, "short": short[j], "unit": units[j], "blind": j in blind} for j in robot.joints],
            self._stages,
        )
        self._chosen = False
        self._follow(robot.joints[0])
        self._run = LiveRun(source, replay=asked["what"] == "replay")
        self._show_form()
        self._show_faults()
        self._show_events()
        self._runner.say(" ".join([f"{robot.name} moves.", *source.notes]))

    def end(self) -> None:
        """Stop what moves."""
        if self._run is not None:
            self._run.stop()
        self._runner.say("Stopped.")
        self._show_form()

    def pause(self) -> None:
        """Pause, or go on."""
        if self._run is not None:
            self._run.pause(not self._run.paused)
            self._show_form()

    def switch(self, fault: Term) -> None:
        """Switch a fault on or off.

        Args:
            fault: One of the source's.
        """
        run = self._run
        if run is None:
            return
        acting = run.source.acting
        if fault in acting:
            acting.remove(fault)
        else:
            acting.add(fault)
        self._show_faults()
        words = fault_words(fault, run.source.robot, joint=True)
        self._runner.say(f"{'On' if fault in acting else 'Off'}: {words}")

    # ------------------------------------------------------------- how it is shown

    def _look(self) -> None:
        run = self._run
        if run is None:
            return
        piece, events = run.take()
        if piece:
            charted: Frame = {
                "time": piece["time"],
                "stage": piece["stage"],
                "residual": piece["residual"],
                "threshold": piece["threshold"],
            }
            if "attached" in piece:
                charted["attached"] = piece["attached"]
            self._live.push(charted)
            drawn = piece.copy()
            del drawn["residual"], drawn["threshold"]
            self._arm.append(drawn, self._stages)
            self._speed.text = f"{run.speed:.1f} × real time, {piece['time'][-1]:.0f} s"
        if events:
            self._events = [*self._events, *events][-MOST_EVENTS:]
            self._show_events()
            if not self._chosen:
                self._follow(events[-1].joints[0])
        if run.ended:
            self._run = None
            if run.error:
                self._runner.refuse(run.error)
            self._show_form()

    def _choose(self, joint: str | None) -> None:
        """Show the joint that somebody chose, from now on."""
        if joint is not None:
            self._chosen = True
            self._follow(joint)

    def _follow(self, joint: str) -> None:
        self._arm.select(joint)
        self._live.select(joint)

    def _show_form(self) -> None:
        form, runs = self._form, self._run is not None and not self._run.ended
        with self._what.filling("done" if runs else "open"):
            with node("div", classes="picker", role="group", aria_label="what moves"):
                for key, name in WHAT.items():
                    choice = node("button", name, type="button", data_mark=f"what-{key}")
                    choice.props["aria-pressed"] = "true" if form["what"] == key else "false"
                    choice.on("click", partial(self._choose_what, key), args=[])
            with node("datalist", id="robots"):
                for name, entry in catalogue().items():
                    node("option", entry.description, value=name)
            ui.input("Robot", value=str(form["robot"])).bind_value_to(form, "robot").props(
                "outlined dense stack-label list=robots data-mark=robot"
            )
            if form["what"] == "replay":
                hint = "path of a log; its first part is taken as healthy"
                ui.input("Log", value=str(form["log"]), placeholder=hint).bind_value_to(form, "log").props(
                    "outlined dense stack-label data-mark=log"
                )
            else:
                ui.textarea(
                    "Faults to switch, one a line",
                    value=str(form["faults"]),
                    placeholder="the usual ones, sized to the arm",
                ).bind_value_to(form, "faults").props(
                    "outlined dense stack-label autogrow data-mark=fault-lines"
                )
                ui.checkbox(
                    "The monitor corrects the control", value=bool(form["accommodate"])
                ).bind_value_to(form, "accommodate").props("dense")
            with node("div", classes="actions"):
                button("Begin anew" if runs else "Begin", self.begin, mark="begin", classes="primary")
                if runs and self._run is not None:
                    button("Go on" if self._run.paused else "Pause", self.pause, mark="pause")
                    button("Stop", self.end, mark="stop")
                self._speed = node("span", classes="soft", data_mark="speed")

    def _choose_what(self, key: str) -> None:
        self._form["what"] = key
        self._show_form()

    def _show_faults(self) -> None:
        run = self._run
        with self._faults.filling("waiting" if run is None else "open"):
            if run is None:
                return
            source = run.source
            for note in source.notes:
                node("p", note, "soft", data_mark="note")
            if not source.faults:
                node("p", "The faults of a log cannot be switched.", "soft")
            for k, fault in enumerate(source.faults):
                acts = fault in source.acting
                words = fault_words(fault, source.robot, joint=True)
                with node(
                    "button",
                    classes="switch",
                    type="button",
                    role="switch",
                    aria_checked="true" if acts else "false",
                    aria_label=words,
                    data_mark=f"fault-{k}",
                    data_fault=fault.label,
                ).on("click", partial(self.switch, fault), args=[]):
                    node("i", aria_hidden="true")
                    node("span", words)

    def _show_events(self) -> None:
        run = self._run
        with self._said.filling("waiting" if run is None else "open"):
            if run is None:
                return
            rows = event_rows(self._events, run.source.robot)
            if not rows:
                node("p", "No event yet: the arm is healthy.", "soft")
            with node("div", classes="events", role="log", aria_label="events"):
                for row in reversed(rows):
                    with node("div", classes="event", data_mark="event", data_stage=row.stage):
                        node("span", f"{row.time:.1f} s", "soft")
                        with node("div"):
                            with node("p"):
                                node("b", row.joints)
                                node(
                                    "span",
                                    f" {row.stage}" + (f", {row.verdict}" if row.verdict else ""),
                                    "soft",
                                )
                            for said in row.said:
                                node("p", said)
                            if row.alternatives:
                                node("p", "or " + ", or ".join(row.alternatives), "soft")
                            if row.reason:
                                node("p", row.reason, "soft")
