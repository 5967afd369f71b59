"""The engines by name; each is imported when a monitor asks for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.engine_interface import Engine
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.errors import ModelError, unknown_name
from cdia_pin.logs.log import Log
from cdia_pin.phrases import plural
from cdia_pin.robot.model import RobotModel

if TYPE_CHECKING:
    from cdia_pin.diagnosis.thesis import ThesisSettings


class EngineName(StrEnum):
    """Names of the engines."""

    MOMENTUM = "momentum"  # residuals in torque units, joint by joint
    THESIS = "thesis"  # the scheme of [Thesis], for study and comparison


def settings_of(engine: str, **chosen: Any) -> MonitorSettings | ThesisSettings:
    """Return settings of an engine by its name.

    Args:
        engine: ``momentum`` or ``thesis``.
        **chosen: Settings that differ from their defaults.

    Raises:
        ModelError: If there is no such engine.
    """
    if engine not in ENGINES:
        raise ModelError(unknown_name("engine", engine, ENGINES))
    if engine == EngineName.MOMENTUM:
        return MonitorSettings(**chosen)
    from cdia_pin.diagnosis.thesis import ThesisSettings

    return ThesisSettings(**chosen)


def require_threshold(threshold: Mapping[str, float], robot: RobotModel) -> None:
    """Check a given threshold.

    Args:
        threshold: Largest healthy residual of each joint [N·m or N].
        robot: The arm.

    Raises:
        ModelError: If a joint is missing or unknown, or a value is not above 0.
    """
    for joint, value in threshold.items():
        if joint not in robot.joints:
            raise ModelError("threshold: " + unknown_name("joint", joint, robot.joints))
        if not 0 < value < math.inf:
            raise ModelError(f"threshold of {joint} must be above 0, given {value}")
    if missing := [j for j in robot.joints if j not in threshold]:
        raise ModelError(f"threshold: no value for {plural('joint', len(missing))} {', '.join(missing)}")


@dataclass(frozen=True)
class Knowledge:
    """What is known of the healthy arm; all but the last of the attributes are arguments of `Monitor`.

    Attributes:
        healthy: Runs of the healthy arm.
        threshold: Largest healthy residual of each joint [N·m or N].
        rate: Ticks per second [Hz].
        position_only: Whether there are no velocities.
        learned: What an engine of the same kind has learned, in place of runs and threshold.
    """

    healthy: tuple[Log, ...] = ()
    threshold: Mapping[str, float] | None = None
    rate: float | None = None
    position_only: bool = False
    learned: Any = None


def _momentum(
    model: Dynamics, bank: Bank, settings: MonitorSettings | ThesisSettings | None, known: Knowledge
) -> tuple[Engine, MonitorSettings | ThesisSettings]:
    from cdia_pin.diagnosis.momentum_engine import MomentumEngine

    if not isinstance(settings, MonitorSettings | None):
        raise ModelError(f"the engine momentum takes MonitorSettings, given {type(settings).__name__}")
    settings = settings or MonitorSettings()
    return MomentumEngine(model, bank, settings, **vars(known)), settings


def _thesis(
    model: Dynamics, bank: Bank, settings: MonitorSettings | ThesisSettings | None, known: Knowledge
) -> tuple[Engine, MonitorSettings | ThesisSettings]:
    from cdia_pin.diagnosis.guard import GuardedEngine
    from cdia_pin.diagnosis.thesis import ThesisEngine, ThesisSettings

    if not isinstance(settings, ThesisSettings | None):
        raise ModelError(f"the engine thesis takes ThesisSettings, given {type(settings).__name__}")
    if known.position_only or any(run.velocity is None for run in known.healthy):
        raise ModelError("the engine thesis observes velocities: record them, or use the engine momentum")
    if any(profile.kind != "always" for profile in bank.profiles):
        raise ModelError("the engine thesis takes no profiles in its bank; use the engine momentum")
    settings = settings or ThesisSettings()
    if known.learned is not None:
        settings = replace(settings, unmodelled=tuple(known.learned.tolist()))
    elif known.threshold is not None:
        joints = model.robot.joints
        settings = replace(settings, unmodelled=tuple(known.threshold[joint] for joint in joints))
    return GuardedEngine(ThesisEngine(model, bank.prototypes, settings, known.healthy)), settings


ENGINES: dict[str, Callable[..., tuple[Engine, MonitorSettings | ThesisSettings]]] = {
    EngineName.MOMENTUM: _momentum,
    EngineName.THESIS: _thesis,
}
