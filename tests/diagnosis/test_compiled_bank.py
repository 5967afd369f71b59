"""Compiled columns are the effects' own: one formula, two ways to evaluate it, the same numbers."""

import importlib
import subprocess
import sys
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy import special

from cdia_pin.diagnosis import MonitorSettings
from cdia_pin.diagnosis.bank import is_followed, prototype
from cdia_pin.diagnosis.compiled_bank import compile_bank, python_columns
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.tick_flags import BAD
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import EFFECTS, Expression, JointEffect, Parameter, Signal, Traits, Unknown
from cdia_pin.robot import load_robot

ROBOT = load_robot("scara")  # has a joint that slides
JOINT = ROBOT.joints[0]
DT = 1e-3


@dataclass(frozen=True)
class HardeningSpring(JointEffect):
    """A user's effect that numba compiles, f = −k (q − r)³."""

    rest: float = 0.1

    name: ClassVar[str] = "hardening_spring"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("stiffness", "{effort}/{position}³", lower=0.0),)
    shape = (Parameter("rest", "{position}", lower=-7.0, upper=7.0),)

    def columns(self, x):
        return [-((x.q - self.rest) ** 3)]


@dataclass(frozen=True)
class Rounded(JointEffect):
    """A user's effect that numba cannot compile, for it asks SciPy; f = a erf(q) + b t."""

    name: ClassVar[str] = "rounded"
    traits: ClassVar[Traits] = Traits({Signal.POSITION, Signal.TIME})
    parameters = (Parameter("height", "{effort}"), Parameter("drift", "{effort}/s"))

    def columns(self, x):
        return [special.erf(x.q), x.time]


@dataclass(frozen=True)
class Table(JointEffect):
    """A user's effect in Python that numba cannot even read."""

    name: ClassVar[str] = "table"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("height", "{effort}"),)

    def columns(self, x):
        table = {"xp": [-1.0, 0.0, 1.0], "fp": [0.0, 2.0, 1.0]}
        return [np.interp(x.q, **table)]


@dataclass(frozen=True)
class Drift(JointEffect):
    """A user's effect that grows with time, in plain numpy; f = a t."""

    name: ClassVar[str] = "drift"
    traits: ClassVar[Traits] = Traits({Signal.TIME})
    parameters = (Parameter("rate", "{effort}/s"),)

    def columns(self, x):
        return [2.0 * x.time]


def effects() -> list[JointEffect]:
    of_joint = [
        e
        for n, e in EFFECTS.items()
        if issubclass(e, JointEffect) and n not in ("unknown", "expression") and is_followed(e(JOINT))
    ]
    slower = EFFECTS["position_ripple"](joint=JOINT, frequency=3.0)
    own = [HardeningSpring(JOINT), Drift(JOINT), Rounded(JOINT)]
    return [
        *(e(joint=JOINT) for e in of_joint),
        slower,
        *own,
        Expression(JOINT, "a*dq**3 + b*sin(2*q)*tau + c*ddq*q"),
        Expression(JOINT, "a*t"),
    ]


def asked() -> list:
    names = [getattr(e, "text", e.name) for e in effects()]
    return [pytest.param(i, id=name) for i, name in enumerate(names)]


@pytest.fixture(scope="module")
def ticked() -> tuple[MomentumObserver, dict]:
    """An observer of all effects after some random ticks, and the last signals."""
    observer = MomentumObserver(Nominal.of(Dynamics(ROBOT)), tuple(effects()), MonitorSettings(), DT)
    rng = np.random.default_rng(0)
    v = np.zeros(ROBOT.n)
    for k in range(5):
        before, (q, v, tau) = v, rng.uniform(-1, 1, (3, ROBOT.n))
        assert not observer.step(k * DT, q, v, tau) & BAD
    return observer, {"q": q, "v": v, "a": (v - before) / DT, "effort": tau, "time": 4 * DT}


@pytest.mark.parametrize("i", asked())
def test_compiled_columns_are_those_of_the_effect(ticked, i: int) -> None:
    observer, x = ticked
    sign = np.tanh(x["v"] / observer.state.sign_width)
    expected = python_columns(observer.effects[i], x["q"], x["v"], x["a"], x["effort"], sign, x["time"])
    found = observer.state.phi[:, observer.ends[i] : observer.ends[i + 1]]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert np.abs(expected).max() > 1e-6


def test_only_what_numba_does_not_understand_is_evaluated_in_python() -> None:
    given = effects()
    compiled = compile_bank(given)
    assert [given[i].name for i in compiled.in_python] == ["rounded", "expression", "expression"]


def test_arms_of_any_number_of_joints_and_neurons_share_the_compiled_code() -> None:
    bank, ticks = (EFFECTS["coulomb_friction"](JOINT), EFFECTS["viscous_friction"](JOINT)), set()
    for name, neurons in (("double_pendulum", (0.0, 1.0)), ("scara", (0.0, 1.0, 2.0))):
        robot = load_robot(name)
        unknown = [
            Unknown(j, position_centres=neurons, velocity_centres=(*neurons, 3.0), damping_centres=neurons)
            for j in robot.joints
        ]
        observer = MomentumObserver(Nominal.of(Dynamics(robot)), bank, MonitorSettings(), DT, unknown)
        v = np.linspace(-1.0, 1.0, robot.n)
        for k in range(3):
            observer.step(k * DT, k * DT * v, v, np.zeros(robot.n))
        np.testing.assert_allclose(observer.state.phi[:, 1], -v)
        ticks.add(observer._compiled.tick)
    assert len(ticks) == 1


def columns_of(effect: JointEffect, time: float = 3.0, q: float = 0.5) -> np.ndarray:
    """Return the columns of an effect alone at one instant, shape (n, p)."""
    observer = MomentumObserver(Nominal.of(Dynamics(ROBOT)), (effect,), MonitorSettings(), DT)
    for t in (time - DT, time):
        observer.step(t, np.full(ROBOT.n, q), np.zeros(ROBOT.n), np.zeros(ROBOT.n))
    return observer.state.phi.copy()


def test_an_effect_that_numba_cannot_even_read_is_evaluated_in_python() -> None:
    np.testing.assert_allclose(columns_of(Table(JOINT)), 1.5)


USERS_MODULE = '''
from dataclasses import dataclass
from typing import ClassVar
from cdia_pin.effects import JointEffect, Parameter, Signal, Traits

@dataclass(frozen=True)
class Mine(JointEffect):
    """f = {factor} q."""

    name: ClassVar[str] = "mine"
    traits: ClassVar[Traits] = Traits({{Signal.POSITION}})
    parameters = (Parameter("size", "1"),)

    def columns(self, x):
        return [{factor} * x.q]
'''


def test_an_effect_whose_source_changes_is_compiled_again(tmp_path, monkeypatch) -> None:
    """A user edits the formula and starts again: what is cached belongs to the old one."""
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    found = []
    for factor in ("2.0", "-3.125"):
        (tmp_path / "users_effect.py").write_text(USERS_MODULE.format(factor=factor))
        sys.modules.pop("users_effect", None)
        importlib.invalidate_caches()
        mine = importlib.import_module("users_effect").Mine(JOINT)
        found.append(columns_of(mine, q=1.0)[0, 0])
    assert found == [2.0, -3.125]


def test_an_effect_on_another_joint_is_the_same_prototype() -> None:
    one, other = (EFFECTS["coulomb_friction"](joint=j) for j in ROBOT.joints[:2])
    assert prototype(other, ROBOT) == one


def test_numba_is_loaded_when_a_monitor_is_made_and_not_before() -> None:
    text = """
import sys
import cdia_pin
from cdia_pin.diagnosis import Bank, Monitor, MonitorSettings
print("numba" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False"]
