"""What the arm is asked to do while it is watched: seeded motions with exact derivatives, beginning at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.plant.motion import BLEND, Fourier, Motion, Plan, Reach, Reference, _quintic


@dataclass(frozen=True)
class Onward(Fourier):
    """A Fourier series on all joints that begins at rest, and still moves when the run ends.

    Attributes:
        base: Base frequency [Hz]; a run of 10 s sees its whole period.
    """

    base: float | None = 0.1

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return a motion that would fade only after `duration` [s]."""
        return super().plan(reach, duration + BLEND, rng)


@dataclass(frozen=True)
class Chain(Motion):
    """Different Fourier series one after the other, at rest in between only for an instant.

    Attributes:
        piece: Length of each series [s].
        bridge: Time from the posture of one to that of the next [s].
        base: Base frequency [Hz]; drawn for each between 0.05 and 0.1 if None.
    """

    piece: float = 17.0
    bridge: float = 3.0
    base: float | None = None

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return as many series as begin within `duration` [s]."""
        count = int(np.ceil(duration / (self.piece + self.bridge)))
        series = [Fourier(base=self.base).plan(reach, self.piece, rng) for _ in range(count)]
        postures = [s(np.zeros(1)).q[0] for s in series]
        postures.append(postures[-1])  # stays where the last one ended

        def at(t: np.ndarray) -> Reference:
            which = np.clip((t // (self.piece + self.bridge)).astype(int), 0, count - 1)
            within = t - which * (self.piece + self.bridge)  # [s]
            q, v, a = (np.empty((len(t), len(reach.joints))) for _ in range(3))
            for k in np.unique(which):
                rows = which == k
                inner = series[k](np.minimum(within[rows], self.piece))
                s, ds, dds = _quintic((within[rows] - self.piece) / self.bridge)
                step = postures[k + 1] - postures[k]
                q[rows] = inner.q + s[:, None] * step
                v[rows] = inner.v + ds[:, None] * step / self.bridge
                a[rows] = inner.a + dds[:, None] * step / self.bridge**2
            return Reference(q, v, a)

        return at
