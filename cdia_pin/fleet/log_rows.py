"""The rows of one log: checked, compared with the model of its robot, fitted, and searched."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from cdia_pin.discovery.trust import variations
from cdia_pin.effects import Effect
from cdia_pin.errors import CdiaError, LogError
from cdia_pin.fleet.columns import COLUMNS
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.fleet_map import FleetRobot
from cdia_pin.fleet.log_fit import LogFit
from cdia_pin.fleet.recording_time import recording_time
from cdia_pin.fleet.robot_setup import RobotSetup, load_setup
from cdia_pin.logs import Log, check_log
from cdia_pin.phrases import LONGEST_REASON, one_line
from cdia_pin.regression.effort_scale import effort_tolerance
from cdia_pin.selection.problem import Problem
from cdia_pin.version import __version__

Row = dict[str, object]


@dataclass(frozen=True)
class FleetLog:
    """A log that is to be added.

    Attributes:
        path: The file.
        robot: Its robot.
        sha256: Hash of its bytes.
    """

    path: Path
    robot: FleetRobot
    sha256: str


def rows_of(log: FleetLog) -> list[Row]:
    """Return the rows of a log; one that fails gives a row with the reason.

    Args:
        log: The log.

    Raises:
        CdiaError: If its robot cannot be loaded: that concerns all of its logs.
    """
    setup, measured = load_setup(log.robot), None
    try:
        measured = setup.read(log.path)
        rows = list(_measured_rows(measured, setup))
    except (CdiaError, OSError, ArithmeticError, np.linalg.LinAlgError) as error:
        rows = [{"failure": one_line(error, LONGEST_REASON)}]
    return _whole(log, setup, measured, rows)


def failure_rows(log: FleetLog, why: str) -> list[Row]:
    """Return the row of a log that ended its work, so that it is known the next time.

    Args:
        log: The log.
        why: What happened.
    """
    return _whole(log, load_setup(log.robot), None, [{"failure": why[:LONGEST_REASON]}])


def _whole(log: FleetLog, setup: RobotSetup, measured: Log | None, rows: Sequence[Row]) -> list[Row]:
    """Return rows with all columns."""
    robot, path = log.robot, log.path
    when = recording_time(measured, path.name, robot.stated_time(path), robot.folders_of(path))
    head: Row = dict.fromkeys(COLUMNS)
    head |= {
        "robot": robot.name,
        "log": path.name,
        "sha256": log.sha256,
        "setup": setup.hash,
        "recorded": when.at,
        "recorded_from": str(when.source),
        "added": datetime.now(UTC),
        "version": __version__,
        "settings": setup.settings,
    }
    return [head | row for row in rows]


def _measured_rows(log: Log, setup: RobotSetup) -> Iterator[Row]:
    """Yield the rows of a log that could be read."""
    robot, settings = setup.model.robot, setup.robot.settings
    check = check_log(log, robot)
    if check.obstacles:
        raise LogError(check.mend)
    effects = [t.effect for t in setup.model.terms]
    problem = Problem.conditioned(robot, [log], [], settings.discovery).without_rest_of(effects)
    fit = LogFit.of(problem.experiment, setup.model, settings)
    repeats = [
        LogFit.of(x, replace(setup.model, robot=x.robot), settings) for x in variations(problem, setup.model)
    ]
    whole: Row = {
        "doubts": "; ".join(f.message for f in check.problems),
        "duration": log.duration,
        "cutoff": fit.motion.cutoff,
    }
    by_joint = {joint: _joint_cells(fit, j) for j, joint in enumerate(robot.joints)}
    for effect, role in fit.every:
        about = whole | (by_joint[effect.scope[0]] if effect.scope else {})
        for row in _effect_rows(effect, role, fit, repeats):
            yield about | row


def _joint_cells(fit: LogFit, j: int) -> Row:
    """Return error, temperature, load and coverage of a joint."""
    motion, experiment = fit.motion, fit.experiment
    warmth = motion.temperature
    speed, position = np.abs(motion.v[motion.kept, j]), motion.q[motion.kept, j]
    return {
        "error": float(fit.error[j]),
        "model_error": float(fit.given_error[j]),
        "temperature": None if warmth is None else float(np.mean(warmth[:, j])),
        "load": float(fit.load[j]),
        "moving": float(experiment.moving[:, j].mean()),
        "speed": float(np.sqrt(np.mean(speed**2))),
        "fastest": float(speed.max()),
        "reach": float(np.ptp(position)),
    }


def _effect_rows(effect: Effect, role: Role, fit: LogFit, repeats: Sequence[LogFit]) -> Iterator[Row]:
    """Yield a row for each parameter of an effect."""
    robot, at_model = fit.experiment.robot, fit.effects.in_model(effect)
    about: Row = {
        "effect": effect.name,
        "joints": "+".join(effect.joints(robot) if effect.scope else ()),
        "role": str(role),
    }
    names = zip(effect.parameters, effect.units(robot), at_model, strict=True)
    head = [about | {"parameter": p.name, "unit": unit, "model_value": float(m)} for p, unit, m in names]
    why = fit.why_not_shown(effect)
    if why:
        yield from (row | {"not_shown": why} for row in head)
        return
    difference, covariance = fit.difference(effect)
    statistical = fit.quantile * np.sqrt(np.diag(covariance))
    if effect.scope and fit.is_drowned(effect, statistical):
        yield from (
            row | {"not_shown": "its interval is as large as the torque of the joint"} for row in head
        )
        return
    moved = [np.abs(r.difference(effect)[0] - difference) for r in repeats if not r.why_not_shown(effect)]
    torque, value = fit.torque(effect, difference), at_model + difference
    scale = effort_tolerance(fit.experiment, effect, fit.torque(effect, value)) * np.abs(value)
    total = np.hypot(statistical, np.hypot(np.max([np.zeros_like(value), *moved], axis=0), scale))
    named = fit.is_named(effect) if role is Role.SEARCHED else None
    for row, v, s, t in zip(head, value, statistical, total, strict=True):
        yield row | {
            "value": float(v),
            "ci95_low": float(v - t),
            "ci95_high": float(v + t),
            "ci95_statistical_low": float(v - s),
            "ci95_statistical_high": float(v + s),
            "torque": float(np.max(torque)),
            "named": named,
        }
