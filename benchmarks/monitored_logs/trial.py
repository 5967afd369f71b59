"""One log with the monitor over it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import nan

import numpy as np
from numpy.typing import NDArray

from benchmarks.monitored_logs.cases import EFFECT, PUSHED, SHARE, WEIGHT, Case
from benchmarks.monitored_logs.outcome import Outcome
from benchmarks.real_residuals.bases import Base, BaseCase, run_base
from benchmarks.real_residuals.draws import NoSizeError, drawn
from benchmarks.real_residuals.failures import failed
from benchmarks.real_residuals.filtered import FilteredLog
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.recordings import Recording, data_folder
from benchmarks.real_residuals.running import store_of
from cdia_pin.changes import Change
from cdia_pin.diagnosis import Event, Monitor, Status, lasting_changes
from cdia_pin.diagnosis.lasting_changes import Disturbances
from cdia_pin.effects import ExternalWrench, Term
from cdia_pin.errors import LogError
from cdia_pin.logs import Log

Array = NDArray[np.float64]

PUSH = 10.0  # [N], force of a sensor from which the arm is pushed


def run_case(case: Case) -> Outcome:
    """Monitor the log of a case."""
    out = Outcome(case.id, case.kind, case.arm)
    try:
        log, term, begin = _given(case)
        monitor = monitor_of(case.before)
        contacts: list[tuple[float, Array]] = []
        disturbed = Disturbances()

        def watch(status: Status) -> None:
            contacts.append((status.time, _force(status.faults)))
            disturbed.see(status)

        monitor.replay(log, watch)
        watched = monitor.at_rate(log)
        lasting = _established(monitor, case.before.read(), watched, disturbed)
    except NoSizeError:
        return replace(out, failure="no such size")
    except Exception as why:
        return replace(out, failure=failed(why))
    events, start = monitor.events, float(log.time[0])
    detections = [e.time for e in events if e.stage == "detection"]
    isolations = [e for e in events if e.stage == "isolation"]
    after = [t for t in detections if t >= begin]
    out = replace(
        out,
        effect=term.label if term else "",
        blind=term is not None and _is_blind(term, monitor),
        detected=after[0] - begin if after and term else nan,
        early=sum(t < begin for t in detections),
        named=tuple(sorted(t.label for t in monitor.faults)),
        sets=_sets(isolations),
        contacts=sum(any(map(_is_contact, e.faults)) for e in isolations),
        ever=tuple(sorted({t.label for e in isolations for t in e.faults if not _is_contact(t)})),
        lasting=tuple(c.term.label for c in lasting),
        lasted=tuple(map(_alike, lasting)),
        kept=log.duration,
        said=tuple(_in_words(e, start) for e in events if e.stage != "accommodation"),
    )
    if term is not None:
        out = _with_size(out, monitor, term)
    if case.kind == WEIGHT:
        out = _with_mass(out, monitor, isolations, detections)
        out = _with_compared_mass(out, lasting)
    if case.kind == PUSHED and case.after.file == "pushed_at_rest":
        out = _with_force(out, contacts)
    return out


@lru_cache(maxsize=2)
def monitor_of(before: Recording) -> Monitor:
    """Return a monitor that knows the model of a healthy log and has learned from it."""
    store, case = store_of("bases", Base.from_json), BaseCase(before)
    base = store.read().get(case.id)
    if base is None:
        base = run_base(case)
        store.add(base)
    return Monitor(base.load(before.robot), healthy=[before.read()])


def _given(case: Case) -> tuple[Log, Term | None, float]:
    """Return the log of a case, the effect in it, and when that begins [s]."""
    log = case.after.read()
    if case.kind != EFFECT:
        return log, None, np.inf
    begin = float(log.time[0] + 0.5 * log.duration)
    return *with_effect(case, log, begin), begin


def with_effect(case: Case, log: Log, begin: float, end: float = np.inf) -> tuple[Log, Term]:
    """Return the log of a case with its effect from one time to another [s], and the effect."""
    before, after = (FilteredLog.of(r.read(), r.robot) for r in (case.before, case.after))
    term = drawn(case.effect, SHARE, before, after, case.seed)
    changed = Insertion(term, after).into(log)
    is_there = ((log.time >= begin) & (log.time < end))[:, None]
    return replace(log, effort=np.where(is_there, changed.effort, log.effort)), term


def _is_blind(term: Term, monitor: Monitor) -> bool:
    sight = monitor.record["sight"]
    return all(sight[joint]["blind"] for joint in term.effect.scope or sight)


def _with_size(out: Outcome, monitor: Monitor, term: Term) -> Outcome:
    found = next((t for t in monitor.faults if t.label == term.label), None)
    if found is None or found.ci95 is None:
        return out
    true = term.theta[0]
    return replace(
        out, size_error=abs(found.theta[0] / true - 1.0), size_half=float(found.half_widths[0]) / abs(true)
    )


def _with_mass(out: Outcome, monitor: Monitor, isolations: list[Event], detections: list[float]) -> Outcome:
    found = next((t for t in monitor.faults if t.effect.name == "payload"), None)
    times = [e.time for e in isolations if "payload" in [t.label for t in e.faults]]
    if found is None or not times or not detections:
        return out
    half = float(found.half_widths[0])
    return replace(out, mass=found.theta[0], mass_half=half, mass_after=times[0] - detections[0])


def _with_compared_mass(out: Outcome, established: tuple[Change, ...]) -> Outcome:
    found = next((c.term for c in established if c.term.effect.name == "payload"), None)
    if found is None:
        return out
    return replace(out, compared_mass=found.theta[0], compared_half=float(found.half_widths[0]))


def _with_force(out: Outcome, contacts: list[tuple[float, Array]]) -> Outcome:
    """Compare the size of the force with that of the sensor at the tool."""
    wrench = np.genfromtxt(data_folder() / "ur5" / "pushed_at_rest_wrench.csv", delimiter=",", names=True)
    force = np.column_stack([wrench[k] for k in ("fx", "fy", "fz")])
    force = force - np.median(force, axis=0)  # the sensor's own zero and the tool's weight: the arm rests
    time, said = np.array([t for t, _ in contacts]), np.array([np.linalg.norm(f) for _, f in contacts])
    size = np.interp(time, wrench["time"], np.linalg.norm(force, axis=1))
    pushed = size > PUSH
    both = pushed & (said > 0)
    if not both.any():
        return replace(out, force_error=np.inf, force_said=0.0)
    error = np.abs(said - size)[both] / size[both]
    return replace(out, force_error=float(np.median(error)), force_said=float(np.mean(said[pushed] > 0)))


def _alike(change: Change) -> tuple[str, ...]:
    """Return the label of a change, and those of single effects that explain as much."""
    return (change.term.label, *(c.effects[0].label for c in change.confusions if len(c.effects) == 1))


def _established(monitor: Monitor, healthy: Log, watched: Log, disturbed: Disturbances) -> tuple[Change, ...]:
    """Return what the comparison of the log's end establishes; nothing where it cannot be compared."""
    try:
        return lasting_changes(monitor.model, [healthy], watched, disturbed=disturbed.mask).established
    except LogError:
        return ()


def _force(faults: tuple[Term, ...]) -> Array:
    return next((np.array(t.theta[:3]) for t in faults if _is_contact(t)), np.zeros(3))


def _is_contact(term: Term) -> bool:
    return isinstance(term.effect, ExternalWrench)


def _sets(isolations: list[Event]) -> tuple[tuple[tuple[str, ...], ...], ...]:
    """Return the sets of labels of the last isolation of each place."""
    last = {e.joints: e for e in isolations}
    return tuple(
        tuple(tuple(t.label for t in one) for one in (e.faults, *e.alternatives)) for e in last.values()
    )


def _in_words(e: Event, start: float) -> str:
    names = " + ".join(t.label for t in e.faults)
    others = "".join(" or " + " + ".join(t.label for t in one) for one in e.alternatives)
    return f"{e.time - start:.2f} s {e.stage} {'+'.join(e.joints)} {e.verdict}: {names}{others}"
