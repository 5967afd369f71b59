"""The inputs of a command, from its options: robot, model and logs."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.cli.console import Tell, warn
from cdia_pin.cli.failures import CommandError
from cdia_pin.input_files import resolved
from cdia_pin.phrases import counted, some

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import Log, LogCheck
    from cdia_pin.logs.formats.guess import ColumnGuess
    from cdia_pin.robot import RobotModel

MOST_TERMS = 5  # terms of a model that are listed before they are counted


@dataclass(frozen=True)
class Reading:
    """How logs are to be read; each field is the option of that name.

    Attributes:
        gains: File of drive gains.
        joint_map: Texts ``name=joint``.
        convert: Texts ``key=value``.
        topic: Topic of a bag.
        format: Name of the format.
        columns: Texts ``signal=pattern``.
        episode: Episode of a LeRobot dataset.
        conditions: Under which condition logs were recorded, by path.
        torque_side: Side of the gear on which the torque was measured, ``motor`` or ``link``.
        ways: How logs were read beyond these fields, as `ways_of` states it. Reading adds to it, and what was answered
            for one log is tried on the next ones before it is asked again.
    """

    gains: Path | None = None
    joint_map: Sequence[str] | None = None
    convert: Sequence[str] | None = None
    topic: str | None = None
    format: str | None = None
    columns: Sequence[str] | None = None
    episode: int | None = None
    conditions: Mapping[Path, str] = field(default_factory=dict)
    torque_side: str | None = None
    ways: list[dict[str, str]] = field(default_factory=list)

    def read(self, path: Path, robot: RobotModel) -> Log:
        """Read one log.

        Args:
            path: The file.
            robot: Whose log it is.
        """
        from cdia_pin.cli.column_dialogue import can_ask
        from cdia_pin.logs.missing_columns import MissingColumnsError

        way: dict[str, str] = {}
        try:
            log = self._read(path, robot)
        except MissingColumnsError as error:
            if not (error.guesses and can_ask()):
                raise
            log, way = self._asked(path, robot, error.guesses)
        if way not in self.ways:
            self.ways.append(way)
        return replace(log, condition=self.conditions.get(path, ""))

    def _asked(
        self, path: Path, robot: RobotModel, guesses: Sequence[ColumnGuess]
    ) -> tuple[Log, dict[str, str]]:
        """Return a log as an earlier one was read, else as a dialogue says, and the answers."""
        from cdia_pin.cli.column_dialogue import asked_columns
        from cdia_pin.errors import LogError

        for way in filter(None, self.ways):
            with contextlib.suppress(LogError):
                return self._with(way)._read(path, robot), way
        way = asked_columns(path.name, guesses, robot)
        return self._with(way)._read(path, robot), way

    def _with(self, more: Mapping[str, str]) -> Reading:
        """Return how to read with more columns, conversions and names of joints."""

        def joined(known: Sequence[str] | None, name: str) -> Sequence[str]:
            return [*(known or ()), *([more[name]] if name in more else ())]

        return replace(
            self,
            columns=joined(self.columns, "columns"),
            convert=joined(self.convert, "convert"),
            joint_map=joined(self.joint_map, "joint_map"),
        )

    def _read(self, path: Path, robot: RobotModel) -> Log:
        from cdia_pin.logs import read_log

        return read_log(
            path,
            robot,
            gains=self.gains,
            joint_map=self.joint_map,
            convert=self.convert,
            topic=self.topic,
            format=self.format,
            columns=self.columns,
            episode=self.episode,
            torque_side=self.torque_side,
        )


def load_inputs(robot: str, model: Path | None) -> Dynamics:
    """Load the robot, with the terms of a saved model if there is one.

    Args:
        robot: Name of the catalogue, or path of a URDF.
        model: File of the model; None for the URDF alone.
    """
    from cdia_pin.dynamics import Dynamics, load_model
    from cdia_pin.dynamics.physical import unphysical
    from cdia_pin.robot import load_robot

    arm = load_robot(robot)
    for sentence in arm.warnings:
        warn(f"{arm.name}: {sentence}")
    known = load_model(model, arm) if model else Dynamics(arm)
    for why in (unphysical(term, arm) for term in known.terms):
        if why:
            warn(f"{model}: {why}: no arm has this")
    return known


def read_logs(
    paths: Sequence[Path],
    robot: RobotModel,
    reading: Reading,
    *,
    check: bool,
    tell: Tell,
    refuse: bool = False,
    like: Dynamics | None = None,
) -> tuple[list[Log], list[LogCheck]]:
    """Read logs and check them, with a warning on stderr where a check finds a problem.

    Args:
        paths: Files.
        robot: Whose logs they are.
        reading: How to read them.
        check: Whether to check them.
        tell: Reports progress.
        refuse: Whether a log that would mislead a search is refused.
        like: A model of earlier logs, whose torque was measured on the same side of the gear.

    Returns:
        The logs, and their checks if they were made.

    Raises:
        CommandError: If a log is refused; the message says what mends it.
    """
    from cdia_pin.logs import check_log

    logs, checks = [], []
    for path in paths:
        tell(f"reading {path.name}", 0.0)
        log = reading.read(path, robot)
        if check:
            tell(f"checking {path.name}", 0.01)
            checks.append(check_log(log, robot))
            if refuse and checks[-1].obstacles:
                raise CommandError(f"{checks[-1].mend}; or go on with --anyway")
            _warn_of(checks[-1], path)
        logs.append(_with_side(log, checks[-1] if check else None, like))
    return logs, checks


def _with_side(log: Log, check: LogCheck | None, model: Dynamics | None) -> Log:
    """Return the log with a note where something else knows better on which side of the gear its torque was measured.

    That is the check, or the logs that the model was learned from. Where nothing knows, and the torque shows friction,
    the note says what follows.
    """
    from cdia_pin.logs.checks import Topic
    from cdia_pin.logs.torque_side import BEHIND_THE_GEAR, TorqueSide

    found = [f.value for f in check.about(Topic.TORQUE_SIDE)] if check else []
    keeps_out = "(--torque-side link keeps them out)"
    if log.side_of_format and any(f.get("side") == TorqueSide.UNKNOWN for f in found):
        others = tuple(note for note in log.notes if not note.startswith(BEHIND_THE_GEAR))
        known = replace(log, torque_side=TorqueSide.UNKNOWN, side_of_format=False, notes=others)
        return known.noted(
            "the torque shows more friction than a sensor behind the gear usually sees, so friction and rotors are "
            f"looked for {keeps_out}"
        )
    if log.torque_side is not TorqueSide.UNKNOWN:
        return replace(log, side_of_format=log.side_of_format and not found)
    measured = {f.get("measured") for f in found}
    side = model.torque_side if model else TorqueSide.UNKNOWN
    if TorqueSide.LINK in measured or (side is TorqueSide.LINK and TorqueSide.MOTOR not in measured):
        why = (
            "because it shows none of a gear"
            if TorqueSide.LINK in measured
            else "as in the logs of the model"
        )
        note = f"{BEHIND_THE_GEAR}, {why} (if that is wrong, --torque-side motor)"
        return replace(log, torque_side=TorqueSide.LINK).noted(note)
    if side is TorqueSide.MOTOR:
        return replace(log, torque_side=side).noted(
            "the torque is taken as that of the motor, as in the logs of the model"
        )
    if any(f.get("side") == TorqueSide.UNKNOWN and f.get("shows_friction") for f in found):
        return log.noted(
            "which side of the gear the torque is from cannot be told: friction of the motor and its rotor are looked "
            f"for {keeps_out}"
        )
    return log


def require_unseen(held_out: Sequence[Path], logs: Sequence[Path]) -> None:
    """Refuse a log that is both fitted and held out.

    Args:
        held_out: Logs to predict.
        logs: Logs to fit.

    Raises:
        CommandError: If there is one.
    """
    fitted = {resolved(p) for p in logs}
    for path in held_out:
        if resolved(path) in fitted:
            raise CommandError(f"{path} is fitted, it cannot be held out too: give another log to --holdout")


def _left_out(log: Log) -> list[str]:
    """Return what is said of the samples of a log that are left out of what is computed."""
    from cdia_pin.logs.wild_samples import said_of, wild_samples

    found = wild_samples(log)
    return [f"{said_of(found, log)}; left out of what is computed"] if found else []


def _warn_of(check: LogCheck, path: Path) -> None:
    if check.ok:
        return
    first, *others = check.problems
    where = f"{first.joint}: " if first.joint else ""
    more = f" (and {len(others)} more)" if others else ""
    advice = f"cdia check {path}, with the same options, says what to do"
    warn(f"{check.source}: {where}{first.message}{more}; {advice}")


def doubts(checks: Sequence[LogCheck]) -> list[str]:
    """Return what makes a result doubtful, a sentence for each log that contradicts its robot.

    Args:
        checks: Checks of the logs.
    """
    found = [c.mend for c in checks if c.obstacles]
    return found + [f"{c.source}: {f.message}; {f.advice}" for c in checks for f in c.about("robot")]


def show_inputs(
    console: Console,
    model: Dynamics,
    logs: Sequence[Log],
    held_out: Sequence[Log] = (),
    *,
    notes: bool = True,
    role: str = "model",
) -> None:
    """Print robot, model and logs of a result, with the notes of the reader.

    Args:
        console: Where.
        model: The robot and its terms.
        logs: Logs that were fitted or checked.
        held_out: Logs that were predicted.
        notes: Whether to print the reader's notes.
        role: What the model is called.
    """
    from rich.table import Table
    from rich.text import Text

    robot = model.robot
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row("robot", Text(f"{robot.name}, {counted(robot.n, 'joint')}"))
    table.add_row(role, Text(some(["the URDF", *(t.label for t in model.terms)], MOST_TERMS)))
    for what, given in (("log", logs), ("held out", held_out)):
        for log in given:
            said = f"{log.source}: {len(log.time)} samples in {log.duration:.4g} s, {log.rate:.4g} Hz"
            table.add_row(what, Text(said))
            for note in (*log.notes, *_left_out(log)) if notes else ():
                table.add_row("", Text(note, style="dim"))
    console.print(table)
    console.print()
