"""The state of a monitor as plain JSON and arrays, and back again: exact, and from a closed list of types.

A number stays the same number to the last bit: JSON gets the shortest text that reads back to it, and arrays stay
binary. Nothing in a file names code that is not in the list below.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import fields
from enum import Enum
from importlib import import_module
from math import isfinite
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import Profile, Term
from cdia_pin.effects.profile import profile_from_dict
from cdia_pin.errors import ModelError
from cdia_pin.robot.model import RobotModel

# Records and enumerations that a state may hold, with their modules.
TYPES: Final[dict[str, str]] = {
    "ArmDecision": "cdia_pin.diagnosis.whole_arm.isolation",
    "ArmSample": "cdia_pin.diagnosis.thesis.sample_interval",
    "ArmTrial": "cdia_pin.diagnosis.whole_arm.trial",
    "Contact": "cdia_pin.diagnosis.whole_arm.wrench",
    "ContactLimits": "cdia_pin.diagnosis.whole_arm.contact",
    "Decision": "cdia_pin.diagnosis.isolation",
    "Event": "cdia_pin.diagnosis.status",
    "EventStage": "cdia_pin.diagnosis.status",
    "FilterDecision": "cdia_pin.diagnosis.thesis.filter_bank",
    "FixedGains": "cdia_pin.diagnosis.thesis.gains",
    "HealthyArm": "cdia_pin.diagnosis.healthy_arm",
    "JointBelief": "cdia_pin.diagnosis.belief",
    "Learned": "cdia_pin.diagnosis.whole_arm.learning",
    "MonitorSettings": "cdia_pin.diagnosis.monitor_settings",
    "Neurons": "cdia_pin.diagnosis.thesis.basis",
    "Question": "cdia_pin.diagnosis.whole_arm.question",
    "SampleBounds": "cdia_pin.diagnosis.sample_bounds",
    "ScaledGains": "cdia_pin.diagnosis.thesis.gains",
    "SensorCondition": "cdia_pin.diagnosis.sensor_fault",
    "SensorFault": "cdia_pin.diagnosis.sensor_fault",
    "SensorSignal": "cdia_pin.diagnosis.sensor_fault",
    "Stage": "cdia_pin.diagnosis.status",
    "Status": "cdia_pin.diagnosis.status",
    "ThesisSettings": "cdia_pin.diagnosis.thesis.thesis_settings",
    "ThresholdForm": "cdia_pin.diagnosis.thesis.threshold",
    "Verdict": "cdia_pin.diagnosis.status",
}
CONTAINERS: Final[dict[str, type]] = {"list": list, "set": frozenset, "deque": deque}


class StateWriter:
    """Turns values into plain JSON, and collects their arrays.

    Args:
        robot: The arm.

    Attributes:
        arrays: Arrays by the path of their value.
    """

    def __init__(self, robot: RobotModel) -> None:
        self.arrays: dict[str, NDArray[Any]] = {}
        self._robot = robot

    def part(self, part: Stateful, path: str) -> dict[str, Any]:
        """Return the record of a part: each attribute of its `STATE`.

        Args:
            part: The part.
            path: Names its arrays.
        """
        return {name: self.value(getattr(part, name), f"{path}/{name}") for name in part.STATE}

    def value(self, x: Any, path: str) -> Any:
        """Return a value as plain JSON.

        Args:
            x: A number, text, array, container, record or part.
            path: Names its arrays.

        Raises:
            ModelError: If it is of a type that cannot be stored.
        """
        out: Any
        if x is None or type(x) in (bool, int, str) or (type(x) is float and isfinite(x)):
            out = x
        elif type(x) is float:
            out = {"float": str(x)}
        elif isinstance(x, np.ndarray):
            self.arrays[path] = x
            out = {"array": path}
        elif isinstance(x, np.generic):
            out = {"number": self.value(x.item(), path), "type": x.dtype.name}
        elif type(x) is tuple:
            out = self._each(x, path)
        elif type(x) is dict:
            out = self._mapping(x, path)
        elif isinstance(x, Stateful):
            out = {"part": self.part(x, path)}
        elif kind := next((name for name, kind in CONTAINERS.items() if type(x) is kind), None):
            out = {kind: self._each(sorted(x) if kind == "set" else x, path)}
        else:
            out = self._record(x, path)
        return out

    def _mapping(self, x: dict[Any, Any], path: str) -> dict[str, Any]:
        if all(type(key) is str for key in x):
            return {"map": {key: self.value(one, f"{path}/{key}") for key, one in x.items()}}
        return {"dict": self._each(x.items(), path)}

    def _each(self, values: Any, path: str) -> list[Any]:
        return [self.value(one, f"{path}/{i}") for i, one in enumerate(values)]

    def _record(self, x: Any, path: str) -> dict[str, Any]:
        out: dict[str, Any]
        if isinstance(x, Enum):
            out = {"enum": _listed(type(x)), "value": x.value}
        elif isinstance(x, RobotModel):
            out = {"robot": x.name}
        elif isinstance(x, Term):
            out = {"term": self.value(dict(x.to_dict(self._robot)), path)}
        elif isinstance(x, Profile):
            out = {"profile": self.value(x.to_dict(), path)}
        elif isinstance(x, Nominal):
            out = {"nominal": self.value((x.delay, x.masses), path)}
        else:
            name, at = _listed(type(x)), fields(x)
            out = {
                "record": name,
                "fields": {f.name: self.value(getattr(x, f.name), f"{path}/{f.name}") for f in at},
            }
        return out


class StateReader:
    """Turns what a `StateWriter` wrote into values again.

    Args:
        arrays: Arrays by path.
        model: The healthy arm as it was before healthy runs corrected it.
    """

    def __init__(self, arrays: Mapping[str, NDArray[Any]], model: Dynamics) -> None:
        self._arrays, self._model = arrays, model

    def part(self, part: Stateful, record: Mapping[str, Any]) -> None:
        """Give a part at its start the state of a record.

        Args:
            part: The part.
            record: As `StateWriter.part` returned it.

        Raises:
            ModelError: If the record is of another kind of part.
        """
        if set(record) != set(part.STATE):
            raise ModelError(f"its {type(part).__name__} holds {', '.join(record) or 'nothing'}")
        for name in part.STATE:
            part.take(name, self.value(record[name], getattr(part, name, None), (part, name)))
        part.restored()

    def value(self, x: Any, now: Any = None, owner: tuple[Stateful, str] | None = None) -> Any:
        """Return a value from plain JSON.

        Args:
            x: As `StateWriter.value` returned it.
            now: What the attribute holds at the start; its parts are taken over.
            owner: Part and attribute that get the value.

        Raises:
            ModelError: If it is not valid.
        """
        if isinstance(x, list):
            return tuple(self._each(x, now, owner))
        if not isinstance(x, dict):
            return x
        if len(x) not in (1, 2):
            raise ModelError("it holds a value without a kind")
        kind, held = next(iter(x.items()))
        if kind == "part":
            assert owner is not None
            part = now if isinstance(now, Stateful) else owner[0].new_part(owner[1])
            self.part(part, held)
            return part
        if kind == "dict":
            before = now if isinstance(now, dict) else {}
            keys = [self.value(key) for key, _ in held]
            return {k: self.value(v, before.get(k), owner) for k, (_, v) in zip(keys, held, strict=True)}
        if kind in CONTAINERS:
            values = self._each(held, now, owner)
            return deque(values, maxlen=now.maxlen) if kind == "deque" else CONTAINERS[kind](values)
        return self._plain(kind, held, x)

    def _each(self, held: list[Any], now: Any, owner: tuple[Stateful, str] | None) -> list[Any]:
        before = now if isinstance(now, list | tuple) else ()
        return [self.value(one, before[i] if i < len(before) else None, owner) for i, one in enumerate(held)]

    def _plain(self, kind: str, held: Any, x: Mapping[str, Any]) -> Any:
        """Return a value without parts."""
        read: dict[str, Callable[[], Any]] = {
            "float": lambda: float(held),
            "number": lambda: np.dtype(x["type"]).type(self.value(held)),
            "array": lambda: self._arrays[held],
            "map": lambda: {k: self.value(v) for k, v in held.items()},
            "robot": lambda: self._model.robot,
            "term": lambda: Term.from_dict(self.value(held)),
            "profile": lambda: profile_from_dict(self.value(held)),
            "nominal": lambda: Nominal.of(self._model).corrected(*self.value(held)),
            "enum": lambda: _type(held)(x["value"]),
            "record": lambda: _type(held)(**{k: self.value(v) for k, v in x["fields"].items()}),
        }
        if kind not in read:
            raise ModelError(f"it holds an unknown kind of value, '{kind}'")
        return read[kind]()


def _listed(kind: type) -> str:
    """Return the name of a record or an enumeration, if it is in the list."""
    if TYPES.get(kind.__name__) != kind.__module__:
        raise ModelError(f"a monitor with a {kind.__name__} cannot be stored")
    return kind.__name__


def _type(name: str) -> Any:
    """Return the record or enumeration of a name, if it is in the list."""
    if name not in TYPES:
        raise ModelError(f"it holds an unknown record '{name}'")
    return getattr(import_module(TYPES[name]), name)
