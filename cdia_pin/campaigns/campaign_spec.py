"""The plan of a campaign as a file states it: which arms, faults and settings, and how often."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from itertools import product
from pathlib import Path
from typing import Any

from cdia_pin.campaigns.closed_loop import LoopSettings
from cdia_pin.diagnosis import DEFAULT_BANK, Bank
from cdia_pin.diagnosis.engines import settings_of
from cdia_pin.effects import parse_term
from cdia_pin.errors import CdiaError, unknown_name
from cdia_pin.input_files import read_text
from cdia_pin.phrases import some
from cdia_pin.robot import load_robot

ANY = "*"  # joint of a term: drawn anew for each arm

Setting = tuple[str, float | int | bool]


class CampaignError(CdiaError):
    """The plan of a campaign, or the folder of its runs, cannot be used."""


@dataclass(frozen=True)
class FaultCase:
    """Faults that act together, as written.

    Attributes:
        terms: ``EFFECT@JOINT: NAME=VALUE, after=4``; the joint ``*`` is drawn, the same for all of them.
        shares: RMS torque of each fault over that of its joint along the motion [1]; the values of a fault are
            multiplied so that it has this size. None leaves the values as they are written.
    """

    terms: tuple[str, ...]
    shares: tuple[float | None, ...] = (None,)


@dataclass(frozen=True)
class CampaignSpec:
    """What a campaign runs: every combination of robots, errors, noises, speeds, settings and faults, many arms each.

    Attributes:
        robots: Names of the catalogue, or paths of URDF files.
        model_error: Largest relative errors of the model's inertias [1].
        noise: Noises of the measured torques over their RMS [1].
        speed: Largest speeds of the motions over the limit of the joint [1], of those too from which monitors learn.
        repeats: Number of arms for each combination; each has its own model error, motion and noise.
        duration: Length of a run with faults [s].
        healthy: Length of the run without faults that each arm makes [s]; 0 for none.
        seed: Seed of all draws.
        rate: Control ticks per second [Hz].
        healthy_runs: Number of healthy runs from which each monitor learns.
        healthy_duration: Length of each of them [s].
        bank: Known effects.
        engine: Of the monitor.
        settings: Values of each of the engine's settings that differ from the defaults.
        faults: What happens to the arms.
        tracking: Whether tracking is compared with the same motion without faults, and without a monitor.
    """

    robots: tuple[str, ...]
    model_error: tuple[float, ...] = (LoopSettings.model_error,)
    noise: tuple[float, ...] = (LoopSettings.noise,)
    speed: tuple[float, ...] = (LoopSettings.speed,)
    repeats: int = 10
    duration: float = 10.0
    healthy: float = 60.0
    seed: int = 0
    rate: float = LoopSettings.rate
    healthy_runs: int = LoopSettings.healthy_runs
    healthy_duration: float = LoopSettings.healthy_duration
    bank: tuple[str, ...] = DEFAULT_BANK
    engine: str = "momentum"
    settings: tuple[tuple[str, tuple[float | int | bool, ...]], ...] = ()
    faults: tuple[FaultCase, ...] = ()
    tracking: bool = True

    def __post_init__(self) -> None:
        if not self.robots:
            raise CampaignError('a campaign needs a robot: robots = ["ur5"]')
        if self.repeats < 1 or not self.duration > 0 or not self.healthy >= 0:
            raise CampaignError(
                "a campaign needs repeats of at least 1, a duration above 0 s and healthy of at least 0 s, given "
                f"{self.repeats}, {self.duration}, {self.healthy}"
            )
        if not self.faults and not self.healthy:
            raise CampaignError("a campaign needs faults, or healthy runs of more than 0 s")
        for case in self.faults:
            if not case.terms or any(s is not None and not s > 0 for s in case.shares):
                raise CampaignError(f"a case of faults needs terms, and shares above 0, given {case}")

    def __repr__(self) -> str:
        return f"CampaignSpec({some(self.robots, 3)}; {len(self.faults)} cases of faults, {self.repeats} repeats)"

    def combinations(self) -> list[tuple[Setting, ...]]:
        """Return every combination of the engine's settings."""
        names = [name for name, _ in self.settings]
        return [tuple(zip(names, values, strict=True)) for values in product(*(v for _, v in self.settings))]

    def loops(self, seed: int) -> list[LoopSettings]:
        """Return the loop of each combination of model error, noise and speed.

        Args:
            seed: Of the arm.

        Raises:
            ModelError: If one of them is not valid.
        """
        return [
            LoopSettings(self.rate, noise, error, self.healthy_runs, self.healthy_duration, seed, speed)
            for error, noise, speed in product(self.model_error, self.noise, self.speed)
        ]

    @property
    def digest(self) -> str:
        """Hash of all that decides what the runs are."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:16]

    def check(self) -> None:
        """Check robots, faults and settings before any run.

        Raises:
            CdiaError: If one of them is not valid.
        """
        for chosen in self.combinations():
            settings_of(self.engine, **dict(chosen))
        for loop in self.loops(abs(self.seed)):
            if not 0 <= loop.model_error <= 0.5:
                raise CampaignError(f"a model error is between 0 and 0.5, given {loop.model_error}")
        for name in self.robots:
            robot = load_robot(name)
            Bank.of(robot, self.bank)
            for case in self.faults:
                for text in case.terms:
                    parse_term(with_joint(text, robot.joints[0]), robot)


def with_joint(text: str, joint: str) -> str:
    """Return a term with its drawn joint.

    Args:
        text: The term as written.
        joint: What ``*`` stands for.
    """
    label, colon, rest = text.partition(":")
    effect, at, where = label.partition("@")
    return f"{effect}{at}{joint if where.strip() == ANY else where}{colon}{rest}"


def read_spec(path: str | Path) -> CampaignSpec:
    """Read the plan of a campaign.

    Args:
        path: TOML file; keys are the attributes of `CampaignSpec`, a value or a list of them. Faults are
            ``[[faults]]`` with ``terms`` and ``share``, settings ``[settings]`` with a value or a list each.

    Raises:
        OSError: If it cannot be read.
        CampaignError: If it holds something else.
    """
    try:
        given = tomllib.loads(read_text(path))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise CampaignError(f"{path} is no plan of a campaign in TOML: {error}") from None
    try:
        return spec_from(given)
    except CampaignError as error:
        raise CampaignError(f"{path}: {error}") from None


def spec_from(given: Mapping[str, Any]) -> CampaignSpec:
    """Return the plan that a document states.

    Args:
        given: The keys of the file.

    Raises:
        CampaignError: If a key is unknown or a value has another type.
    """
    _require_known("key of a campaign", given, [f.name for f in fields(CampaignSpec)])
    out: dict[str, Any] = {}
    for name, value in given.items():
        if name == "faults":
            out[name] = tuple(_fault_case(one) for one in value)
        elif name == "settings":
            out[name] = tuple((k, tuple(_listed(v))) for k, v in sorted(value.items()))
        elif name in {"robots", "bank"}:
            out[name] = tuple(_of_type(str, name, v) for v in _listed(value))
        elif name in {"model_error", "noise", "speed"}:
            out[name] = tuple(_number(name, v) for v in _listed(value))
        elif name in {"repeats", "seed", "healthy_runs"}:
            out[name] = _of_type(int, name, value)
        elif name == "tracking":
            out[name] = _of_type(bool, name, value)
        elif name == "engine":
            out[name] = _of_type(str, name, value)
        else:
            out[name] = _number(name, value)
    return CampaignSpec(**{"robots": (), **out})


def plan_text(spec: CampaignSpec) -> str:
    """Return a plan as TOML, which `read_spec` reads back.

    Args:
        spec: The plan.
    """
    lines = []
    for f in fields(spec):
        value = getattr(spec, f.name)
        if f.name not in {"settings", "faults"}:
            lines.append(f"{f.name} = {_toml(value)}")
    if spec.settings:
        lines += ["", "[settings]", *(f"{name} = {_toml(values)}" for name, values in spec.settings)]
    for case in spec.faults:
        lines += ["", "[[faults]]", f"terms = {_toml(case.terms)}"]
        if case.shares != (None,):
            lines.append(f"share = {_toml(case.shares)}")
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    """Return a value as TOML; a string of JSON is one of TOML."""
    return f"[{', '.join(map(_toml, value))}]" if isinstance(value, tuple) else json.dumps(value)


def _fault_case(given: Mapping[str, Any]) -> FaultCase:
    _require_known("key of a fault", given, ["terms", "share"])
    terms = tuple(_of_type(str, "terms", t) for t in _listed(given.get("terms", [])))
    shares = tuple(_number("share", s) for s in _listed(given["share"])) if "share" in given else (None,)
    return FaultCase(terms, shares)


def _require_known(kind: str, given: Mapping[str, Any], known: list[str]) -> None:
    for name in given:
        if name not in known:
            raise CampaignError(unknown_name(kind, name, known))


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CampaignError(f"{name} takes a number, given {value!r}")
    return float(value)


def _of_type(kind: type, name: str, value: Any) -> Any:
    if type(value) is not kind:
        raise CampaignError(f"{name} takes a value of type {kind.__name__}, given {value!r}")
    return value
