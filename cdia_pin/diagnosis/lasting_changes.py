"""What lasts until the end of a monitored log: its last part is compared with the healthy runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes import Change, Changes, what_changed
from cdia_pin.changes.changes_documents import ChangesJson
from cdia_pin.changes.confidence import Confidence
from cdia_pin.diagnosis.begin_of_change import begin_of
from cdia_pin.diagnosis.status import NO_CONTACT, Status
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ExternalWrench
from cdia_pin.errors import CdiaError, LogError
from cdia_pin.logs.checks.sampling import runs
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.log import Log
from cdia_pin.logs.motion import Motion
from cdia_pin.selection.discovery_settings import DiscoverySettings

Mask = NDArray[np.bool_]

# A drive warms up within minutes, and a change that began late fills a small share of a long window.
LEAST_LONGEST = 60.0  # [s]; the longest window is as long as the healthy runs, and at least this
SHORTER = 0.5  # length of a window over that of the one before [1]
# A later begin leaves out more of the window than this: a block of the comparison.
LEAST_SHARE = 0.0625  # [1]


class LastingJson(TypedDict):
    """What lasts until the end, in files of the schema cdia-events/1: begin and end of the window [s], and changes."""

    begin: float
    end: float
    changes: ChangesJson


class Disturbances:
    """Which samples of a monitored run say nothing about the arm: contacts and sensors at fault hide it.

    What was called a contact and turned out to be none hides nothing.
    """

    def __init__(self) -> None:
        self._touched: list[bool] = []
        self._broken: list[bool] = []

    def __len__(self) -> int:
        return len(self._touched)

    def see(self, status: Status) -> None:
        """Add a sample.

        Args:
            status: After its tick.
        """
        if any(e.reason == NO_CONTACT for e in status.events):
            for k in reversed(range(len(self))):
                if not self._touched[k]:
                    break
                self._touched[k] = False
        self._touched.append(any(isinstance(t.effect, ExternalWrench) for t in status.faults))
        self._broken.append(bool(status.sensors))

    @property
    def mask(self) -> Mask:
        """True for samples that say nothing about the arm, shape (N,)."""
        touched, broken = np.array([self._touched, self._broken], dtype=bool)
        return np.asarray(touched | broken)


@dataclass(frozen=True, repr=False)
class LastingChanges:
    """Changes of the arm since its healthy runs that last until the end of a run.

    Attributes:
        begin: Begin of the window that was compared [s].
        end: Its end [s]: that of the log, or of the last stretch without contact and with good sensors.
        changes: What differs between the healthy runs and the window.
    """

    begin: float
    end: float
    changes: Changes

    def __repr__(self) -> str:
        return f"LastingChanges({self.begin:.4g} to {self.end:.4g} s, {len(self.established)} established)"

    @property
    def established(self) -> tuple[Change, ...]:
        """The changes that are established, the most evident first."""
        return tuple(c for c in self.changes.changes if c.confidence is Confidence.ESTABLISHED)

    @property
    def labels(self) -> set[str]:
        """What differs, by name and scope."""
        return {c.term.label for c in self.changes.changes}

    @property
    def sure(self) -> set[str]:
        """What differs for sure, by name and scope; all that differs if nothing is sure."""
        return {c.term.label for c in self.established} or self.labels

    def confirmed_by(self, longer: LastingChanges) -> LastingChanges:
        """Return the same sizes, with what a longer window establishes as established.

        Args:
            longer: The comparison of a window of which this one is a part.
        """
        sure = {c.term.label for c in longer.established}

        def confirmed(change: Change) -> Change:
            certain = change.term.label in sure and not change.term.may_be_nothing
            return replace(change, confidence=Confidence.ESTABLISHED) if certain else change

        changes = tuple(map(confirmed, self.changes.changes))
        return replace(self, changes=replace(self.changes, changes=changes))

    @property
    def evidence(self) -> tuple[float, float]:
        """Logarithm of the likelihood that would be lost without what is established, and without all changes [1]."""
        return sum(c.evidence for c in self.established), sum(c.evidence for c in self.changes.changes)

    def to_dict(self) -> LastingJson:
        """Return the comparison as files of the schema cdia-events/1 have it."""
        return {"begin": self.begin, "end": self.end, "changes": self.changes.to_dict()}


def lasting_changes(
    model: Dynamics,
    healthy: Sequence[Log],
    run: Log,
    *,
    disturbed: Mask | None = None,
    settings: DiscoverySettings | None = None,
) -> LastingChanges:
    """Compare the last part of a run with healthy runs.

    When a change began is not known. So several windows are compared, each half as long as the one before, and all of
    them end where the last undisturbed stretch ends. The window counts in which what is established is most evident, or
    what is likely, if nothing is. One that begins before its changes holds two arms: it tells what changed, and the
    part from there on how much.

    Args:
        model: The model of the arm.
        healthy: Runs of the healthy arm.
        run: The monitored run, N samples.
        disturbed: True for samples that say nothing about the arm, such as those of a push, shape (N,).
        settings: What may have changed, and how logs are conditioned.

    Returns:
        The comparison of the window.

    Raises:
        LogError: If nothing can be compared, as in runs that are too short.
    """
    settings = settings or DiscoverySettings()
    longest = max(sum(log.duration for log in healthy), LEAST_LONGEST)
    least = settings.changes.blocks * settings.changes.independent_time
    quiet = np.ones(len(run.time), dtype=bool) if disturbed is None else ~disturbed

    def conditioned(logs: Sequence[Log], side: str) -> list[Motion]:
        return [condition(log, model.robot, settings.searched) for log in _named(logs, side)]

    before = conditioned(healthy, "healthy")

    def compared(window: Log, motion: Motion) -> LastingChanges:
        changes = what_changed(model, before, motion, settings=settings)
        return LastingChanges(float(window.time[0]), float(window.time[-1]), changes)

    def since_it_changed(window: Log) -> LastingChanges:
        (motion,) = conditioned([window], "the end")
        whole = compared(window, motion)
        if not whole.changes.changes:
            return whole
        with suppress(CdiaError, np.linalg.LinAlgError):  # then nothing tells when it changed
            later = _from(window, begin_of(before, motion, whole.changes, settings.rest))
            if least <= later.duration <= (1.0 - LEAST_SHARE) * window.duration:
                part = compared(later, *conditioned([later], "the end"))
                return part.confirmed_by(whole) if whole.sure <= part.labels else whole
        return whole

    found: list[LastingChanges] = []
    refused: list[CdiaError] = []
    for window in _windows(_last_stretch(run, quiet, least), longest, least):
        try:
            found.append(since_it_changed(window))
        except CdiaError as why:  # this part cannot be compared; a shorter one may be
            refused.append(why)
    if not found:
        raise LogError(str(refused[0]))
    return max(found, key=lambda one: one.evidence)


def _from(log: Log, begin: float) -> Log:
    """Return the part of a log from some time on [s]."""
    return log.slice(int(np.searchsorted(log.time, begin)), len(log.time))


def _last_stretch(run: Log, quiet: Mask, least: float) -> Log:
    """Return the last stretch of quiet samples that is long enough."""
    for start, stop in reversed(list(zip(*runs(quiet), strict=True))):
        if run.time[stop - 1] - run.time[start] >= least:
            return run.slice(int(start), int(stop))
    raise LogError(f"{run.source}: no {least:g} s without contact and with good sensors")


def _windows(stretch: Log, longest: float, least: float) -> Iterator[Log]:
    """Yield the windows of a stretch, the longest first."""
    length = min(longest, stretch.duration)
    while length >= least:
        yield _from(stretch, stretch.time[-1] - length)
        length *= SHORTER


def _named(logs: Sequence[Log], side: str) -> list[Log]:
    """Return logs with names that differ between the sides, since both may be parts of one file."""
    return [replace(log, source=f"{log.source} ({side})") for log in logs]
