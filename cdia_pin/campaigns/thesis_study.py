"""The two numerical studies of [Thesis] §4.3 on the SCARA arm: accommodation, and isolation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from enum import StrEnum
from itertools import combinations, islice

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.campaigns.scara_run import UNITS, Job, ScaraRun, Scenario, run_together
from cdia_pin.campaigns.thesis_presets import (
    KNOWN,
    KNOWN_BOUND,
    PRESETS,
    UNMODELLED,
    Preset,
    isolation_faults,
)
from cdia_pin.campaigns.thesis_records import ThesisStudyRecord
from cdia_pin.diagnosis.status import Verdict
from cdia_pin.diagnosis.thesis import ThesisEngine, ThesisSettings
from cdia_pin.errors import ModelError, unknown_name
from cdia_pin.phrases import shortened
from cdia_pin.progress import Progress, silent
from cdia_pin.robot import load_robot
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SETTLED = 2.0  # [s], from the last onset to the start of the comparison: time for an isolation
GRACE = 2.0  # [s], time for the isolation filters to learn before their residuals count


class LearningRule(StrEnum):
    """Whether isolation filters have time to learn before they are compared with their thresholds."""

    NO_GRACE = "as printed"
    WITH_GRACE = "with 2 s to learn"


@dataclass(frozen=True, eq=False, repr=False)
class Case:
    """Three runs of one scenario.

    Attributes:
        name: Kind of fault.
        began: Onset of the first fault [s].
        since: Start of the comparison of tracking [s].
        healthy: Run without faults.
        faulty: Run with faults and without compensation.
        accommodated: Run with faults and the engine.
    """

    name: str
    began: float
    since: float
    healthy: ScaraRun
    faulty: ScaraRun
    accommodated: ScaraRun

    def __repr__(self) -> str:
        return f"Case({shortened(self.name)}, faults from {self.began:g} s)"

    def tracking(self) -> dict[str, Array]:
        """Return the RMS position error of each run by its name [rad or m], shape (4,) each."""
        runs = {"healthy": self.healthy, "faulty": self.faulty, "accommodated": self.accommodated}
        return {name: r.tracking(self.since) for name, r in runs.items()}

    @property
    def worse(self) -> tuple[int, ...]:
        """Indices of the joints that track no better with the engine than without it."""
        rms = self.tracking()
        return tuple(np.flatnonzero(rms["accommodated"] >= rms["faulty"]).tolist())

    @property
    def detected_after(self) -> float | None:
        """Time from the first onset to its detection [s]; None if there was none."""
        times = [e.time for e in self.accommodated.events if e.stage == "detection"]
        return times[0] - self.began if times else None


@dataclass(frozen=True, repr=False)
class Isolation:
    """Result of the isolation of one combination of faults.

    Attributes:
        true: Names of the true effects.
        rule: Whether filters had time to learn.
        verdict: Verdict of the isolation; ``none`` without one.
        first: Names of the effects of the smallest combination that was not excluded; empty without one.
        survivors: Number of combinations that were not excluded, of seven.
        after: Time from the onset to the verdict [s]; None without a verdict.
    """

    true: tuple[str, ...]
    rule: LearningRule
    verdict: Verdict
    first: tuple[str, ...]
    survivors: int
    after: float | None

    def __repr__(self) -> str:
        return f"Isolation({shortened(' + '.join(self.true), 80)}, {self.rule}: {self.verdict})"

    @property
    def isolated(self) -> bool:
        """True if the true combination, and no other, was not excluded."""
        return self.verdict is Verdict.UNIQUE and self.first == self.true

    @property
    def preferred(self) -> bool:
        """True if the true combination is the smallest that was not excluded."""
        return bool(self.first) and self.first == self.true


@dataclass(frozen=True, eq=False, repr=False)
class ThesisStudy:
    """Result of `thesis_study`.

    Attributes:
        joints: Names of the joints.
        presets: Presets by name.
        cases: Runs of each preset.
        isolations: Results of isolation, one per combination of faults and rule.
        isolation_case: Runs of a single Coulomb fault with a bank, for the figures.
    """

    joints: tuple[str, ...]
    presets: dict[str, Preset]
    cases: dict[str, tuple[Case, ...]]
    isolations: tuple[Isolation, ...]
    isolation_case: Case

    def __repr__(self) -> str:
        count = sum(len(cases) for cases in self.cases.values())
        return f"ThesisStudy({len(self.presets)} presets, {count} cases, {len(self.isolations)} isolations)"

    def to_dict(self) -> ThesisStudyRecord:
        """Return the numbers as ``cdia study thesis --json`` writes them."""
        return {
            "schema": schemas.STUDY_THESIS,
            "robot": "scara",
            "joints": list(self.joints),
            "units": dict(zip(self.joints, UNITS, strict=True)),
            "presets": {
                name: {
                    "about": self.presets[name].about,
                    "cases": [
                        {
                            "name": case.name,
                            "since": case.since,
                            "detected_after": case.detected_after,
                            "not_accommodated": [self.joints[j] for j in case.worse],
                            "tracking_rms": {
                                kind: dict(zip(self.joints, rms.tolist(), strict=True))
                                for kind, rms in case.tracking().items()
                            },
                        }
                        for case in cases
                    ],
                }
                for name, cases in self.cases.items()
            },
            "isolation": [
                {**asdict(i), "isolated": i.isolated, "preferred": i.preferred} for i in self.isolations
            ],
        }


def thesis_study(
    presets: tuple[str, ...] = ("literal", "physical"), progress: Progress = silent
) -> ThesisStudy:
    """Run both studies.

    Args:
        presets: Names of the presets of the first study; the second study has its own faults.
        progress: Called with the current work and the share that is done [1].

    Returns:
        Results of both studies.

    Raises:
        ModelError: If a preset is unknown.
    """
    for name in presets:
        if name not in PRESETS:
            raise ModelError(unknown_name("preset", name, PRESETS))
    robot = load_robot("scara")
    chosen = {name: PRESETS[name](robot) for name in presets}
    mixtures = list(_mixtures())
    shown = _scenario(("coulomb_friction",))
    planned = {
        name: {
            case: _jobs(scenario, ThesisEngine(robot, settings=preset.settings))
            for case, scenario in preset.cases.items()
        }
        for name, preset in chosen.items()
    }
    isolating = [_isolating(robot, rule, scenario) for _, rule, scenario in mixtures]
    figures = _jobs(shown, _engine(robot, LearningRule.WITH_GRACE))
    of_cases = [job for cases in planned.values() for jobs in cases.values() for job in jobs]
    runs = iter(run_together([*of_cases, *figures, *isolating], progress))
    cases = {
        name: tuple(
            _case(case, chosen[name].cases[case], *islice(runs, len(jobs))) for case, jobs in of.items()
        )
        for name, of in planned.items()
    }
    in_figures = _case("Coulomb friction, with a bank", shown, *islice(runs, len(figures)))
    isolations = tuple(
        _isolation(true, rule, scenario, found)
        for (true, rule, scenario), found in zip(mixtures, runs, strict=True)
    )
    return ThesisStudy(robot.joints, chosen, cases, isolations, in_figures)


def run_case(name: str, scenario: Scenario, engine: ThesisEngine) -> Case:
    """Run a scenario without faults, with faults, and with faults and the engine.

    Args:
        name: Kind of fault.
        scenario: Faults and conditions.
        engine: The engine at its start.

    Returns:
        The three runs.
    """
    return _case(name, scenario, *run_together(_jobs(scenario, engine)))


def _jobs(scenario: Scenario, engine: ThesisEngine) -> tuple[Job, Job, Job]:
    """Return the runs of a case, in the order of `_case`."""
    return Job(scenario.healthy), Job(scenario), Job(scenario, engine)


def _case(name: str, scenario: Scenario, healthy: ScaraRun, faulty: ScaraRun, accommodated: ScaraRun) -> Case:
    began = [f.start for f in scenario.faults]
    return Case(name, min(began), max(began) + SETTLED, healthy, faulty, accommodated)


def _mixtures() -> Iterator[tuple[tuple[str, ...], LearningRule, Scenario]]:
    names = tuple(isolation_faults())
    for rule in LearningRule:
        for size in range(1, len(names) + 1):
            for true in combinations(names, size):
                yield true, rule, _scenario(true)


def _scenario(true: tuple[str, ...]) -> Scenario:
    faults = isolation_faults()
    return Scenario(tuple(faults[name] for name in true), UNMODELLED, duration=8.0)


def _engine(robot: RobotModel, rule: LearningRule) -> ThesisEngine:
    grace = GRACE if rule is LearningRule.WITH_GRACE else 0.0
    return ThesisEngine(robot, KNOWN, ThesisSettings(unmodelled=KNOWN_BOUND, grace=grace))


def _isolating(robot: RobotModel, rule: LearningRule, scenario: Scenario) -> Job:
    """Return the run of one combination of faults, until the first verdict of the bank."""
    engine = _engine(robot, rule)
    return Job(scenario, engine, until=lambda events: any(e.stage == "isolation" for e in events))


def _isolation(true: tuple[str, ...], rule: LearningRule, scenario: Scenario, found: ScaraRun) -> Isolation:
    """Return the first verdict of the bank in a run."""
    said = [e for e in found.events if e.stage == "isolation"]
    if not said:
        return Isolation(true, rule, Verdict.NONE, (), 0, None)
    first = said[0]
    order = [e.name for e in KNOWN]
    named = tuple(sorted({t.effect.name for t in first.faults}, key=order.index))
    survivors = len(first.alternatives) + 1 if first.verdict in {Verdict.UNIQUE, Verdict.AMBIGUOUS} else 0
    return Isolation(
        true, rule, first.verdict, named, survivors, first.time - min(f.start for f in scenario.faults)
    )
