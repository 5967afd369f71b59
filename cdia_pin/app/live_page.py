"""The second page: faults are switched while an arm moves, or a log is monitored as it would have been live."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from nicegui import context, ui

from cdia_pin.app.elements import ArmElement, LiveElement
from cdia_pin.app.live_bench import LiveBench
from cdia_pin.app.live_run import LiveRun
from cdia_pin.app.parts import PageStep, button, node
from cdia_pin.app.runner_bar import RunnerBar
from cdia_pin.diagnosis.sight import blind_joints
from cdia_pin.fault_report import fault_sentence
from cdia_pin.robot import catalogue
from cdia_pin.viewers.event_words import event_rows, fault_words
from cdia_pin.viewers.scene import Frame, monitor_stages
from cdia_pin.viewers.words import joint_units, short_names

LOOK = 0.1  # [s], between looks at what is new
WHAT = {"simulate": "Simulate", "replay": "Replay a log"}


class LivePage:
    """One tab: the elements that show a bench. What is done goes to the bench; what is new there is shown.

    Args:
        bench: What is shown.
        leave: Called when the tab has gone.
    """

    def __init__(self, bench: LiveBench, leave: Callable[[], None]) -> None:
        self._bench, self._leave = bench, leave
        bench.arrive()
        context.client.on_delete(self._close)  # also of a page that cannot be built
        context.client.on_exception(self._crashed)
        self._run: LiveRun | None = None  # what the page shows
        self._shown: dict[Callable[[], None], object] = {}  # the state that each view shows
        self._stages = [s.to_dict() for s in monitor_stages()]
        with node("div", classes="page"):
            with node("div", classes="steps"):
                RunnerBar(bench.runner)
                self._what = PageStep(1, "What moves", "what")
                self._faults = PageStep(2, "Faults", "faults")
                self._said = PageStep(3, "Events of the monitor", "events")
            with node("div", classes="stage", data_state="waiting") as self._stage:
                self._arm = ArmElement(bench.choose)
                self._arm.props["data-mark"] = "arm"
                self._live = LiveElement(bench.choose)
        self._look()
        ui.timer(LOOK, self._look)

    def _close(self) -> None:
        self._bench.leave()
        self._leave()

    def _crashed(self, error: Exception) -> None:
        """Say what has failed on the page itself, and a way on."""
        fault = fault_sentence(error, "cdia app: the page")
        self._bench.runner.refuse(f"{fault}. Load this page again: the run is kept.")

    # ------------------------------------------------------------- how it is shown

    def _look(self) -> None:
        """Show what has changed since the last look."""
        bench = self._bench
        bench.look()
        run = bench.run
        if run is not None and run is not self._run:
            self._draw(run)
        self._run = run
        views: dict[Callable[[], None], object] = {
            self._show_form: (bench.form["what"], bench.moves, run is not None and run.paused),
            self._show_faults: None if run is None else (run, frozenset(run.source.acting)),
            self._show_events: None if run is None else (run, run.events),
            self._follow: bench.joint,
        }
        for view, state in views.items():
            if view not in self._shown or self._shown[view] != state:
                self._shown[view] = state
                view()
        if run is not None and (piece := self._new()):
            self._push(run, piece)

    def _draw(self, run: LiveRun) -> None:
        """Draw the arm of a run anew."""
        source = run.source
        robot = source.robot
        self._stage.props["data-state"] = "open"
        self._stage.update()
        if self._bench.scene is not None:
            self._arm.draw(self._bench.scene, self._stages, source.reach.tolist())
        short = short_names(robot.joints)
        units = {j: joint_units(robot, j)["load"] for j in robot.joints}
        blind = blind_joints(source.monitor.record["sight"])
        self._live.begin(
            [{"name": j, "short": short[j], "unit": units[j], "blind": j in blind} for j in robot.joints],
            self._stages,
        )
        self._new = run.frames.reader()
        self._shown.clear()

    def _push(self, run: LiveRun, piece: Frame) -> None:
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

    def _follow(self) -> None:
        if joint := self._bench.joint:
            self._arm.select(joint)
            self._live.select(joint)

    def _show_form(self) -> None:
        bench, run = self._bench, self._run
        form, runs = bench.form, bench.moves
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
                button("Begin anew" if runs else "Begin", bench.begin, mark="begin", classes="primary")
                if runs and run is not None:
                    button("Go on" if run.paused else "Pause", bench.pause, mark="pause")
                    button("Stop", bench.end, mark="stop")
                self._speed = node("span", classes="soft", data_mark="speed")

    def _choose_what(self, key: str) -> None:
        self._bench.form["what"] = key
        self._look()

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
                ).on("click", partial(self._bench.switch, fault), args=[]):
                    node("i", aria_hidden="true")
                    node("span", words)

    def _show_events(self) -> None:
        run = self._run
        with self._said.filling("waiting" if run is None else "open"):
            if run is None:
                return
            rows = event_rows(run.events, run.source.robot)
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
