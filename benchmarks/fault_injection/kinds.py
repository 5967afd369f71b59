"""Kinds of bad samples: each spoils a recording from a tick on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.fault_injection.recordings import Samples

RATE = 1000  # [Hz]
SHORT, BURST, LASTING = 0.2, 0.5, 1.0  # [s], length of disturbances; what lasts is to be named
ABSURD = {"nan": np.nan, "inf": np.inf, "-inf": -np.inf, "1e200": 1e200}
SIGNALS = ("q", "v", "tau")
NAMES = {"q": "position", "v": "velocity", "tau": "torque"}


@dataclass(frozen=True)
class Spoil:
    """Where a recording is to be spoiled.

    Attributes:
        k: The tick.
        j: The joint, one that moves there.
        other: Another joint.
        rng: Source of what is drawn.
        fastest: Largest speed of each joint [rad/s or m/s].
        strongest: Largest torque of each joint [N·m or N].
    """

    k: int
    j: int
    other: int
    rng: np.random.Generator
    fastest: np.ndarray
    strongest: np.ndarray

    def span(self, seconds: float) -> slice:
        """Return the ticks of a disturbance of a length [s]."""
        return slice(self.k, self.k + round(seconds * RATE))


@dataclass(frozen=True)
class Kind:
    """A kind of bad sample.

    Attributes:
        name: In words.
        spoil: Returns the spoiled samples; it may write into those that it is given.
        accused: Signal of the sensor that must be named, of the spoiled joint; empty if none has to be.
        is_burst: Whether it lasts, so that sensors may be named.
    """

    name: str
    spoil: Callable[[Samples, Spoil], Samples]
    accused: str = ""
    is_burst: bool = False


def kinds() -> tuple[Kind, ...]:
    """Return all kinds; the first spoils nothing."""
    return (
        Kind("nothing", lambda s, at: s),
        *_values(),
        *_spikes(),
        *_times(),
        *(replace(k, is_burst=True) for k in _bursts()),
        *_sensors(),
        *_nominals(),
    )


def _set(signal: str, value: float) -> Callable[[Samples, Spoil], Samples]:
    def spoil(s: Samples, at: Spoil) -> Samples:
        if signal == "t":
            s.t[at.k] = value
        else:
            getattr(s, signal)[at.k, at.j] = value
        return s

    return spoil


def _values() -> Iterator[Kind]:
    for word, value in ABSURD.items():
        for signal in SIGNALS:
            yield Kind(f"{NAMES[signal]} {word}", _set(signal, value))
        yield Kind(f"time {word}", _set("t", value))
    yield Kind("encoder says 100", _set("q", 100.0))
    yield Kind("torque 1e6", _set("tau", 1e6))


def _spikes() -> Iterator[Kind]:
    def add(signal: str, size: Callable[[Spoil], float]) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            getattr(s, signal)[at.k, at.j] += size(at) * at.rng.choice([-1, 1])
            return s

        return spoil

    def times(signals: tuple[str, ...], factor: float) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            for signal in signals:
                getattr(s, signal)[at.k] *= factor
            return s

        return spoil

    def swap(seconds: float) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            rows, pair = at.span(seconds), [at.j, at.other]
            for signal in SIGNALS:
                x = getattr(s, signal)
                x[rows, pair[0]], x[rows, pair[1]] = x[rows, pair[1]].copy(), x[rows, pair[0]].copy()
            return s

        return spoil

    def bits(s: Samples, at: Spoil) -> Samples:
        """Flip one bit of a number, in twenty samples."""
        for i in range(20):
            x = getattr(s, str(at.rng.choice(SIGNALS)))
            row = at.k + 50 * i
            word = x[row : row + 1, at.rng.integers(x.shape[1])].view(np.uint64)
            word ^= np.uint64(1) << np.uint64(at.rng.integers(64))
        return s

    yield Kind("encoder spike of 0.1", add("q", lambda at: 0.1))
    yield Kind("encoder spike of 0.001", add("q", lambda at: 0.001))
    yield Kind("velocity spike of half the limit", add("v", lambda at: 0.5 * at.fastest[at.j]))
    yield Kind("torque spike of twice the largest", add("tau", lambda at: 2 * at.strongest[at.j]))
    for signal in SIGNALS:
        yield Kind(f"sign of the {NAMES[signal]} flipped", times((signal,), -1.0))
    for signal in SIGNALS:
        yield Kind(f"{NAMES[signal]} zeroed", times((signal,), 0.0))
    yield Kind("all signals zeroed", times(SIGNALS, 0.0))
    yield Kind("one bit flipped, 20 times in a second", bits)
    yield Kind("two joints swapped, once", swap(1 / RATE))
    yield Kind("two joints swapped for 0.2 s", swap(SHORT), is_burst=True)


def _times() -> Iterator[Kind]:
    def order(change: Callable[[np.ndarray, int], np.ndarray]) -> Callable[[Samples, Spoil], Samples]:
        return lambda s, at: s.rows(change(np.arange(len(s.t)), at.k))

    def later(seconds: float, *, once: bool = False) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            s.t[at.k : at.k + 1 if once else None] += seconds
            return s

        return spoil

    def jitter(s: Samples, at: Spoil) -> Samples:
        rows = at.span(BURST)
        s.t[rows] += at.rng.uniform(-0.4, 0.4, len(s.t[rows])) / RATE
        return s

    def again(rows: np.ndarray, k: int) -> np.ndarray:
        return np.insert(rows, k, rows[k])

    def reordered(rows: np.ndarray, k: int) -> np.ndarray:
        rows[[k, k + 1]] = rows[[k + 1, k]]
        return rows

    def late(rows: np.ndarray, k: int) -> np.ndarray:
        return np.insert(np.delete(rows, k), k + 10, k)

    def stale(rows: np.ndarray, k: int) -> np.ndarray:
        """Ten samples that wait, and then arrive in the reverse order."""
        rows[k : k + 10] = rows[k : k + 10][::-1]
        return rows

    yield Kind("tick doubled", order(again))
    yield Kind("ticks reordered", order(reordered))
    yield Kind("sample late by 10 ticks", order(late))
    yield Kind("ten samples in the reverse order", order(stale))
    yield Kind("3 ticks missing", order(lambda rows, k: np.delete(rows, slice(k, k + 3))))
    yield Kind("10 ticks missing", order(lambda rows, k: np.delete(rows, slice(k, k + 10))))
    yield Kind("gap of 1 s", order(lambda rows, k: np.delete(rows, slice(k, k + RATE))))
    yield Kind("clock set back by 100 s", later(-100.0))
    yield Kind("clock set forward by 1000 s", later(1000.0))
    yield Kind("clock 1000 s ahead, once", later(1000.0, once=True))
    yield Kind("times off by up to 0.4 ticks for 0.5 s", jitter)


def _bursts() -> Iterator[Kind]:
    def nan(step: int) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            for signal in SIGNALS:
                getattr(s, signal)[at.span(BURST)][::step] = np.nan
            return s

        return spoil

    def noise(signal: str, size: Callable[[Spoil], float]) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            x = getattr(s, signal)[at.span(SHORT), at.j]
            x += size(at) * at.rng.uniform(-1, 1, len(x))
            return s

        return spoil

    def coarse(s: Samples, at: Spoil) -> Samples:
        x = s.q[at.span(BURST), at.j]
        x[:] = 0.01 * np.rint(x / 0.01)
        return s

    def held(ticks: int) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            for signal in SIGNALS:
                getattr(s, signal)[at.k : at.k + ticks] = getattr(s, signal)[at.k]
            return s

        return spoil

    yield Kind("nan in all signals for 0.5 s", nan(1))
    yield Kind("nan in every other sample for 0.5 s", nan(2))
    yield Kind("encoder noise of 0.05 for 0.2 s", noise("q", lambda at: 0.05))
    yield Kind("velocity noise of 20 % of the limit for 0.2 s", noise("v", lambda at: 0.2 * at.fastest[at.j]))
    yield Kind("torque noise of the largest torque for 0.2 s", noise("tau", lambda at: at.strongest[at.j]))
    yield Kind("torque noise of half of it for 0.2 s", noise("tau", lambda at: 0.5 * at.strongest[at.j]))
    yield Kind("torque noise of a tenth of it for 0.2 s", noise("tau", lambda at: 0.1 * at.strongest[at.j]))
    yield Kind("encoder rounded to 0.01 for 0.5 s", coarse)
    yield Kind("the same sample for 10 ticks", held(10))
    yield Kind("the same sample for 0.2 s", held(round(SHORT * RATE)))


def _sensors() -> Iterator[Kind]:
    def lasting(
        signal: str, value: Callable[[np.ndarray, Spoil], object]
    ) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            x = getattr(s, signal)[at.span(LASTING), at.j]
            x[:] = value(x, at)
            return s

        return spoil

    for signal in SIGNALS:
        yield Kind(f"{NAMES[signal]} frozen for 1 s", lasting(signal, lambda x, at: x[0]), NAMES[signal])
    for signal in ("v", "tau"):
        yield Kind(f"{NAMES[signal]} dead for 1 s", lasting(signal, lambda x, at: 0.0), NAMES[signal])
    yield Kind("encoder dead for 1 s", lasting("q", lambda x, at: 0.0), "position")
    for signal in SIGNALS:
        yield Kind(f"{NAMES[signal]} nan for 1 s", lasting(signal, lambda x, at: np.nan), NAMES[signal])
    yield Kind(
        "velocity biased by 10 % of the limit for 1 s",
        lasting("v", lambda x, at: x + 0.1 * at.fastest[at.j]),
        "velocity",
    )

    def shifted(size: float) -> Callable[[Samples, Spoil], Samples]:
        def spoil(s: Samples, at: Spoil) -> Samples:
            s.q[at.k :, at.j] += size
            return s

        return spoil

    yield Kind("encoder jumps by 0.05 and stays", shifted(0.05), "position")
    yield Kind("encoder jumps by -0.02 and stays", shifted(-0.02), "position")


def _nominals() -> Iterator[Kind]:
    for word, value in ABSURD.items():
        yield Kind(f"nominal torque {word}", _set("nominal", value))

    def burst(s: Samples, at: Spoil) -> Samples:
        s.nominal[at.span(BURST)] = np.nan
        return s

    def desired(s: Samples, at: Spoil) -> Samples:
        return replace(s, desired=np.where(np.arange(len(s.t))[:, None] < at.k, s.desired, np.nan))

    yield Kind("nominal torque nan for 0.5 s", burst)
    yield Kind("desired velocity nan from then on", desired)
