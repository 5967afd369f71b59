"""Compile a bank: the columns of its effects, from their own source, and the tick around them.

An effect is written once, in numpy. Its method ``columns`` reads signals by name and is a function of arrays,
whether they run over samples or over joints: numba compiles it as it stands. What numba does not understand, a
line of arithmetic or a user's class with richer Python, is evaluated in Python at every tick instead.

The generated module is kept in a cache folder beside numba's own cache of it, so that the second start of a
program does not compile again.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import os
import sys
import tempfile
from collections import namedtuple
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

import cdia_pin
from cdia_pin.effects import JointEffect, JointState

HEADER = '''"""Generated: the columns of {names}, and a tick with them."""

from collections import namedtuple

import numpy as np
from numba import njit

from cdia_pin.diagnosis.kernels import BAD, VELOCITY, WIDTH, Neurons, Signals
from cdia_pin.diagnosis.kernels import activate, advance, correction, learn
from cdia_pin.effects.unknown import Unknown

activations = njit(Unknown.columns)
'''
TAIL = '''

@njit(cache=True)
def basis(x, out):
    """Fill the columns of all joints, shape (n, P)."""
{fills}

@njit(cache=True)
def tick(
    joint, columns, gram, absent, mass, phi, interval, ends,
    centres, widths, neurons, neuron_gram, learning,
    q, v, tau, M, nle, dt, bandwidth, forget, remember, debounce, idle,
):
    if not (np.isfinite(q).all() and np.isfinite(v).all() and np.isfinite(tau).all()):
        return BAD
    E = np.exp(-bandwidth * dt)
    a = (v - joint[VELOCITY]) / dt
    x = Signals(q, v, a, tau, np.tanh(v / joint[WIDTH]), q)
    basis(x, phi)
    if learning:
        activate(joint, neurons, activations(Neurons(centres[0], centres[1], widths[0], widths[1]), x), E)
    asks = advance(
        joint, columns, gram, absent, mass, phi, interval, ends, q, v, tau, M, nle, a, E, forget, debounce, idle
    )
    if learning:
        learn(joint, neurons, neuron_gram, remember)
    return asks


@njit(cache=True)
def correct(
    joint, columns, phi0, phi1, interval, smooth, centres, widths, neurons, learning,
    q, v, direction, a, tau, width, floor, divide,
):
    still = np.zeros_like(q)
    sign = np.tanh(direction / width)
    x = Signals(q, v, a, still, sign, q)
    basis(x, phi0)
    basis(Signals(q, v, a, tau, sign, q), phi1)
    active = [still]
    if learning:
        active = activations(Neurons(centres[0], centres[1], widths[0], widths[1]), x)
    return correction(joint, columns, neurons, active, phi0, phi1, interval, smooth, tau, floor, divide)
'''


@dataclass(frozen=True)
class Compiled:
    """A compiled bank.

    Attributes:
        tick: One tick, see `kernels.advance`.
        correct: The correction of a torque, see `kernels.correction`.
        in_python: Effects whose columns numba cannot compile, by index; they are filled before each call.
    """

    tick: Any
    correct: Any
    in_python: tuple[int, ...]


def compile_bank(effects: Sequence[JointEffect]) -> Compiled:
    """Compile the columns of effects, side by side in the order given."""
    in_python = tuple(i for i, e in enumerate(effects) if not _compiles(e))
    module = _load(_source(effects, in_python))
    return Compiled(module.tick, module.correct, in_python)


def python_columns(effect: JointEffect, q: Any, v: Any, a: Any, effort: Any, sign: Any, time: float) -> Any:
    """Return the columns of an effect for all joints at once, shape (n, p)."""
    x = JointState(q, v, a, effort, sign, np.full_like(q, time))
    return np.stack([np.broadcast_to(c, q.shape) for c in effect.columns(x)], axis=1)


_KNOWN_TO_COMPILE: dict[type, bool] = {}


def _compiles(effect: JointEffect) -> bool:
    """Tell whether numba understands the columns of an effect: those that ship do, others are tried."""
    kind = type(effect)
    if kind not in _KNOWN_TO_COMPILE:
        _KNOWN_TO_COMPILE[kind] = _is_importable(kind) and (_ships(kind) or _tried(effect))
    return _KNOWN_TO_COMPILE[kind]


def _ships(kind: type) -> bool:
    return kind.__module__.startswith("cdia_pin.effects.") and kind.__name__ not in ("Expression", "Unknown")


def _is_importable(kind: type) -> bool:
    """Tell whether generated code can import the class by its name."""
    return kind.__module__ != "__main__" and "<" not in kind.__qualname__ and "." not in kind.__qualname__


def _tried(effect: JointEffect) -> bool:
    import numba

    from cdia_pin.diagnosis.kernels import Signals

    if not effect.shape_values and vars(effect).keys() - {"joint"}:
        return False  # reads attributes that are not numbers of its shape
    namespace: dict[str, Any] = {}
    exec(_shape_class(0, effect), {"namedtuple": namedtuple}, namespace)
    shape = namespace["Shape0"](*_shape(effect).values())
    ones = np.ones(2)
    try:
        numba.njit(type(effect).columns)(shape, Signals(ones, ones, ones, ones, ones, ones))
    except (numba.core.errors.NumbaError, TypeError, AttributeError):
        return False
    return True


def _shape(effect: JointEffect) -> dict[str, float]:
    return effect.shape_values or {"none": 0.0}


def _shape_class(i: int, effect: JointEffect) -> str:
    return f'Shape{i} = namedtuple("Shape{i}", "{" ".join(_shape(effect))}")'


def _source(effects: Sequence[JointEffect], in_python: Sequence[int]) -> str:
    """Return the module's text, which depends on nothing but the effects and this package's own text."""
    lines, fills, at = [], [], 0
    for i, effect in enumerate(effects):
        if i not in in_python:
            kind = type(effect)
            values = ", ".join(repr(float(v)) for v in _shape(effect).values())
            lines += [
                f"from {kind.__module__} import {kind.__name__}",
                _shape_class(i, effect),
                f"columns{i} = njit({kind.__name__}.columns)",
            ]
            fills += [f"    c = columns{i}(Shape{i}({values}), x)"]
            fills += [f"    out[:, {at + k}] = c[{k}]" for k in range(effect.size)]
        at += effect.size
    names = ", ".join(e.name for e in effects) or "nothing"
    return HEADER.format(names=names) + "\n".join(lines) + TAIL.format(fills="\n".join(fills) or "    pass")


def _load(source: str) -> ModuleType:
    """Import the generated module from the cache folder, writing it there first."""
    name = f"tick_{_fingerprint(source)}"
    if name in sys.modules:
        return sys.modules[name]
    for folder in _folders():
        path = folder / f"{name}.py"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if not path.exists():
                draft = path.with_suffix(f".{os.getpid()}")
                draft.write_text(source, encoding="utf-8")
                draft.replace(path)  # at once, so that two programs that start together do not meet half a file
        except OSError:
            continue
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module
    raise OSError("no folder to keep compiled code in")  # pragma: no cover  (a temporary one always works)


def _folders() -> Iterator[Path]:
    """Yield the user's cache folder, then a private one that lasts no longer than the machine's memory of it."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    yield Path(home) / "cdia-pin" / "kernels"
    yield Path(tempfile.mkdtemp(prefix="cdia-pin-"))


def _fingerprint(source: str) -> str:
    """Return a hash that changes with all the text that is compiled, of which numba sees only a part."""
    from cdia_pin.diagnosis import kernels

    digest = hashlib.sha256(f"{cdia_pin.__version__}\n{source}".encode())
    modules = {line.split()[1] for line in source.splitlines() if line.startswith("from cdia_pin.effects")}
    digest.update(inspect.getsource(kernels).encode())
    for module in sorted(modules):
        digest.update(inspect.getsource(sys.modules[module]).encode())
    return digest.hexdigest()[:16]
