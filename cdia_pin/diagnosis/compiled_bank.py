"""A compiled bank: the columns of its effects, compiled from their own source, and the tick around them.

An effect is written once, in numpy. Its method ``columns`` reads signals by name and is a function of arrays. The
arrays may run over samples or over joints, so numba compiles the method as it stands. An effect that numba does not
understand, such as a line of arithmetic or a user's class with richer Python, is evaluated in Python at every tick.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import kernel_rows as rows
from cdia_pin.diagnosis.kernel_cache import first_call, load
from cdia_pin.diagnosis.layout import allocate, layout, sides
from cdia_pin.effects import JointEffect, JointState, Signal

Array = NDArray[np.float64]

HEADER = '''"""Generated: the columns of {names}, and a tick with them."""

from collections import namedtuple

import numpy as np
from numba import njit

from cdia_pin.diagnosis.kernel_rows import (
    ABSENT_TICKS, ADDITION, BANDWIDTH, CORRECTS, DAMPING_NEURONS, DEBOUNCE, DRIVEN, FORGET, GAIN_FLOOR, LEARNING,
    LEARNS, NEURON_COUNT, OF_POSITION, OF_VELOCITY, PHI_LOADED, PHI_TICK, PHI_UNLOADED, POSITION, POSITION_NEURONS,
    REMEMBER, SIGN_WIDTH, SOFT_SIGN_WIDTH, TIME, VELOCITY, VELOCITY_NEURONS, WEIGHTS,
)
from cdia_pin.diagnosis.kernels import (
    NEURON_PERIOD, Neurons, Signals, activate, advance, correction, learn,
)
from cdia_pin.diagnosis.tick_flags import BAD
from cdia_pin.effects.unknown import Unknown

activations = njit(Unknown.columns, error_model="numpy")
INTERVAL = np.array({interval})
SMOOTH = np.array({smooth})
ENDS = np.array({ends})
'''
# Effects that ship compile for numbers too, which takes no arrays; a user's may need arrays.
EACH_JOINT = """    for j in range(len(x.q)):
        own = Signals(x.q[j], x.v[j], x.a[j], x.effort[j], x.sign[j], x.time[j])"""
# A flag is never written as a literal there: numba would compile what gets it once more for each of its values.
TAIL = '''

@njit(cache=True)
def basis(x, out):
    """Fill the columns of all joints, shape (n, P)."""
{fills}

@njit(cache=True)
def activity(joint, neurons, position_centres, velocity_centres, damping_centres, widths, x, weighted):
    """Return the activations of the joints that learn, with ``weighted`` of those with weights, shape (n, H)."""
    n, H = neurons.shape[1:]
    out = np.zeros((n, H))
    for j in range(n):
        if joint[LEARNING, j] == 0.0 or weighted and not neurons[WEIGHTS, j].any():
            continue
        of_joint = Neurons(
            position_centres[:, j], velocity_centres[:, j], damping_centres[:, j],
            widths[OF_POSITION, j], widths[OF_VELOCITY, j],
        )
        own = Signals(x.q[j], x.v[j], x.a[j], x.effort[j], x.sign[j], x.time[j])
        active = activations(of_joint, own)
        for k in range(H):
            out[j, k] = active[k]
    return out


@njit(cache=True)
def tick(state, q, v, tau, M, nle, t):
    """Advance all joints by one tick; return what needs attention."""
    for j in range(len(q)):
        if not (np.isfinite(q[j]) and np.isfinite(v[j]) and np.isfinite(tau[j])):
            return BAD
{views}
    dt = t - scalars[TIME]
    scalars[TIME] = t
    E = np.exp(-joint[BANDWIDTH] * dt)
    a = (v - joint[VELOCITY]) / dt
    time = np.full_like(q, t)
    x = Signals(q, v, a, tau, np.tanh(v / joint[SIGN_WIDTH]), time)
    basis(x, phi[PHI_TICK])
    learns = False
    if scalars[LEARNS] > 0.0:
        scalars[NEURON_COUNT] += 1.0
        learns = scalars[NEURON_COUNT] >= NEURON_PERIOD
    if learns:
        scalars[NEURON_COUNT] = 0.0
        active = activity(
            joint, neurons, position_centres, velocity_centres, damping_centres, widths, x, not learns
        )
        activate(joint, neurons, active, E**NEURON_PERIOD)
    asks = advance(
        joint, columns, gram, absent, mass, phi[PHI_TICK], INTERVAL, ENDS, q, v, tau, M, nle, a, E,
        scalars[FORGET], scalars[DEBOUNCE], scalars[ABSENT_TICKS],
    )
    if learns:
        learn(joint, neurons, neuron_gram, scalars[REMEMBER])
    if scalars[CORRECTS] > 0.0:
        still = np.zeros_like(q)
        corrected(state, v, still, tau, scalars[CORRECTS] <= 0.0, joint[ADDITION])
    return asks


@njit(cache=True)
def corrected(state, direction, a, tau, divide, out):
    """Fill in the torque in place of a nominal one, or what to add to it, shape (n,)."""
{views}
    still = np.zeros_like(tau)
    time = np.full_like(tau, scalars[TIME])
    sign = np.tanh(direction / joint[SOFT_SIGN_WIDTH])
    x = Signals(joint[POSITION], joint[VELOCITY], a, still, sign, time)
    basis(x, phi[PHI_UNLOADED])
    loaded = phi[PHI_UNLOADED]
    if scalars[DRIVEN] > 0.0:
        loaded = phi[PHI_LOADED]
        basis(Signals(joint[POSITION], joint[VELOCITY], a, tau, sign, time), loaded)
    active = np.zeros((0, 0))
    if scalars[LEARNS] > 0.0:
        # A steep function of the measured velocity, fed back, would make the arm chatter.
        wanted = Signals(joint[POSITION], direction, a, still, sign, time)
        active = activity(
            joint, neurons, position_centres, velocity_centres, damping_centres, widths, wanted,
            scalars[LEARNS] > 0.0,
        )
    correction(
        joint, columns, neurons, active, phi[PHI_UNLOADED], loaded, INTERVAL, SMOOTH, tau, scalars[GAIN_FLOOR],
        divide, out,
    )
'''


@dataclass(frozen=True)
class CompiledBank:
    """A compiled bank.

    Attributes:
        tick: One tick, see `kernels.advance`.
        corrected: The correction of a torque, see `kernels.correction`.
        in_python: Indices of the effects that numba cannot compile. The caller fills their columns before each call.
    """

    tick: Any
    corrected: Any
    in_python: tuple[int, ...]


def compile_bank(effects: Sequence[JointEffect]) -> CompiledBank:
    """Compile the columns of effects, side by side in the given order; all arms share the code.

    Args:
        effects: Effects of one joint, on any joint.
    """
    in_python = tuple(i for i, e in enumerate(effects) if not _compiles(e))
    module = load(_source(effects, in_python), effects)
    if not module.tick.signatures:
        from cdia_pin.diagnosis import kernels

        first_call("the known effects", (module, kernels), lambda: _tried_once(module, effects))
    return CompiledBank(module.tick, module.corrected, in_python)


def _tried_once(module: Any, effects: Sequence[JointEffect]) -> None:
    """Call a generated module with an arm of zeros, in the types of a control loop."""
    from cdia_pin.diagnosis import kernels

    joints, neurons = 2, (2, 2, 2, 1)  # as few as differ from a single number
    zero, M = np.zeros(joints), np.zeros((joints, joints))
    state, parts = allocate(layout(joints, effects, neurons))
    parts["scalars"][list(rows.NEURONS)] = neurons[:-1]
    module.tick(state, zero, zero, zero, M, zero, 1.0)
    module.corrected(state, zero, zero, zero, True, np.empty(joints))
    kernels.refresh(parts["joint"], parts["columns"], parts["neurons"], 0)
    kernels.believes_in(parts["columns"], np.zeros(parts["columns"].shape[2], bool))


def python_columns(
    effect: JointEffect, q: Array, v: Array, a: Array, effort: Array, sign: Array, time: float
) -> Array:
    """Return the columns of an effect for all joints at once, shape (n, p).

    Args:
        effect: The effect; its joint does not matter.
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,).
        a: Accelerations [rad/s² or m/s²], shape (n,).
        effort: Torques [N·m or N], shape (n,).
        sign: Smoothed sign of the velocity [1], shape (n,).
        time: Time [s].
    """
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
        return False  # it reads attributes other than the numbers of its shape
    shape: Any = namedtuple("Shape0", list(_shape(effect)))  # type: ignore[misc]
    values = shape(*_shape(effect).values())
    ones = np.ones(2)
    compiled: Any = numba.njit(type(effect).columns)
    try:
        compiled(values, Signals(ones, ones, ones, ones, ones, ones))
    except Exception:  # numba fails in many ways at what it does not know
        return False
    return True


def _shape(effect: JointEffect) -> dict[str, float]:
    return effect.shape_values or {"none": 0.0}


def _shape_class(i: int, effect: JointEffect) -> str:
    return f'Shape{i} = namedtuple("Shape{i}", "{" ".join(_shape(effect))}")'


def _views(effects: Sequence[JointEffect]) -> str:
    """Return the lines that view the parts of the state, of which the scalars come first."""
    lines = [
        "n, end = len(tau), 0",
        "K, L, D = int(state[POSITION_NEURONS]), int(state[VELOCITY_NEURONS]), int(state[DAMPING_NEURONS])",
        "H, H1 = K + L + D + 1, K + L + D + 2",
    ]
    for part, shape in sides(effects).items():
        size, shown = (sign.join(map(str, shape)) for sign in (" * ", ", "))
        lines += [f"begin, end = end, end + {size}", f"{part} = state[begin:end].reshape(({shown},))"]
    return "\n".join(f"    {line}" for line in lines)


def _source(effects: Sequence[JointEffect], in_python: Sequence[int]) -> str:
    """Return the text of the generated module; it depends on the effects and this package's own text alone."""
    lines: list[str] = []
    of_joint: list[str] = []
    of_all: list[str] = []
    at = 0
    for i, effect in enumerate(effects):
        if i not in in_python:
            kind = type(effect)
            values = ", ".join(repr(float(v)) for v in _shape(effect).values())
            lines += [
                f"from {kind.__module__} import {kind.__name__}",
                _shape_class(i, effect),
                f'columns{i} = njit({kind.__name__}.columns, error_model="numpy")',
            ]
            fills, indent, at_joint, signals = (
                (of_joint, "        ", "j", "own") if _ships(kind) else (of_all, "    ", ":", "x")
            )
            fills += [f"{indent}c = columns{i}(Shape{i}({values}), {signals})"]
            fills += [f"{indent}out[{at_joint}, {at + k}] = c[{k}]" for k in range(effect.size)]
        at += effect.size
    sizes = [e.size for e in effects]
    fills = ([EACH_JOINT, *of_joint] if of_joint else []) + of_all
    depends_on = [e.traits.depends_on for e in effects]
    head = HEADER.format(
        names=", ".join(e.name for e in effects) or "nothing",
        interval=np.repeat(
            [bool({Signal.TORQUE, Signal.ACCELERATION} & s) for s in depends_on], sizes
        ).tolist(),
        smooth=np.repeat([Signal.ACCELERATION in s for s in depends_on], sizes).tolist(),
        ends=np.cumsum([0, *sizes]).tolist(),
    )
    tail = TAIL.format(fills="\n".join(fills) or "    pass", views=_views(effects))
    return head + "\n".join(lines) + tail
