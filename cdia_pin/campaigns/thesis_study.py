"""The two numerical studies of [Thesis] §4.3 on the SCARA arm: accommodation, and isolation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.campaigns.scara_run import UNITS, Run, Scenario, run
from cdia_pin.campaigns.thesis_presets import (
    KNOWN,
    KNOWN_BOUND,
    PRESETS,
    UNMODELLED,
    Preset,
    isolation_faults,
)
from cdia_pin.diagnosis.thesis import ThesisEngine, ThesisSettings
from cdia_pin.errors import ModelError, unknown_name
from cdia_pin.robot import load_robot
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Tell = Callable[[str, float], None]

SETTLED = 2.0  # [s] after the last fault began, from which tracking is compared
GRACE = 2.0  # [s], in which filters may learn, where they may
NO_GRACE, WITH_GRACE = "as printed", f"with {GRACE:g} s to learn"


@dataclass(frozen=True, eq=False)
class Case:
    """One scenario, three times.

    Attributes:
        name: What breaks.
        began: When the first fault begins [s].
        since: From when on tracking is compared [s].
        healthy: Without fault.
        faulty: Without correction.
        accommodated: With the engine.
    """

    name: str
    began: float
    since: float
    healthy: Run
    faulty: Run
    accommodated: Run

    def tracking(self) -> dict[str, Array]:
        """Return the RMS of the position error of each run [rad or m], shape (4,) each."""
        runs = {"healthy": self.healthy, "faulty": self.faulty, "accommodated": self.accommodated}
        return {name: r.tracking(self.since) for name, r in runs.items()}

    @property
    def worse(self) -> tuple[int, ...]:
        """Indices of the joints that track no better accommodated than faulty."""
        rms = self.tracking()
        return tuple(np.flatnonzero(rms["accommodated"] >= rms["faulty"]).tolist())

    @property
    def detected_after(self) -> float | None:
        """Time from the first fault to its detection [s]; None if there was none."""
        times = [e.time for e in self.accommodated.events if e.stage == "detection"]
        return times[0] - self.began if times else None


@dataclass(frozen=True)
class Isolation:
    """What the bank said of one combination of faults.

    Attributes:
        true: Effects that were there.
        rule: Whether filters had time to learn.
        verdict: ``unique``, ``ambiguous``, ``unknown``, or ``none`` if nothing was said.
        first: Effects of the survivor with the fewest, as the engine prefers it; empty if none survived.
        survivors: How many combinations survived, of seven.
        after: Time from fault to verdict [s]; None if nothing was said.
    """

    true: tuple[str, ...]
    rule: str
    verdict: str
    first: tuple[str, ...]
    survivors: int
    after: float | None

    @property
    def isolated(self) -> bool:
        """Whether the true combination, and no other, was named."""
        return self.verdict == "unique" and self.first == self.true

    @property
    def preferred(self) -> bool:
        """Whether the true combination is the smallest that survived."""
        return bool(self.first) and self.first == self.true


@dataclass(frozen=True, eq=False)
class ThesisStudy:
    """Result of `thesis_study`.

    Attributes:
        joints: Names of the joints.
        presets: What was asked for, by name.
        cases: Runs of each preset.
        isolations: Verdicts, one per combination of faults and rule.
        isolation_case: The single Coulomb fault with a bank, for the figures.
    """

    joints: tuple[str, ...]
    presets: dict[str, Preset]
    cases: dict[str, tuple[Case, ...]]
    isolations: tuple[Isolation, ...]
    isolation_case: Case

    def to_dict(self) -> dict[str, Any]:
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
                {**i.__dict__, "isolated": i.isolated, "preferred": i.preferred} for i in self.isolations
            ],
        }


def thesis_study(
    presets: tuple[str, ...] = ("literal", "physical"), progress: Tell = lambda sentence, share: None
) -> ThesisStudy:
    """Run both studies.

    Args:
        presets: Of the first study; the second has one of its own.
        progress: Told what is being done, and the share that is done.

    Raises:
        ModelError: If a preset is unknown.
    """
    for name in presets:
        if name not in PRESETS:
            raise ModelError(unknown_name("preset", name, PRESETS))
    robot = load_robot("scara")
    chosen = {name: PRESETS[name](robot) for name in presets}
    mixtures = list(_mixtures())
    total = sum(len(p.cases) for p in chosen.values()) + len(mixtures) + 1
    done = 0

    def tell(sentence: str) -> None:
        nonlocal done
        progress(sentence, done / total)
        done += 1

    cases: dict[str, tuple[Case, ...]] = {}
    for name, preset in chosen.items():
        runs = []
        for case, scenario in preset.cases.items():
            tell(f"{name}: {case}")
            runs.append(run_case(case, scenario, ThesisEngine(robot, settings=preset.settings)))
        cases[name] = tuple(runs)
    isolations = []
    for true, rule, scenario in mixtures:
        tell(f"isolation {rule}: {' + '.join(true)}")
        isolations.append(_isolate(robot, true, rule, scenario))
    tell("isolation: figures")
    scenario = _scenario(("coulomb_friction",))
    shown = run_case("Coulomb friction, with a bank", scenario, _engine(robot, WITH_GRACE))
    return ThesisStudy(robot.joints, chosen, cases, tuple(isolations), shown)


def run_case(name: str, scenario: Scenario, engine: ThesisEngine) -> Case:
    """Run a scenario without fault, with it, and with the engine."""
    began = [f.start for f in scenario.faults]
    return Case(
        name, min(began), max(began) + SETTLED, run(scenario.healthy), run(scenario), run(scenario, engine)
    )


def _mixtures() -> Iterator[tuple[tuple[str, ...], str, Scenario]]:
    names = tuple(isolation_faults())
    for rule in (NO_GRACE, WITH_GRACE):
        for size in range(1, len(names) + 1):
            for true in combinations(names, size):
                yield true, rule, _scenario(true)


def _scenario(true: tuple[str, ...]) -> Scenario:
    faults = isolation_faults()
    return Scenario(tuple(faults[name] for name in true), UNMODELLED, duration=8.0)


def _engine(robot: RobotModel, rule: str) -> ThesisEngine:
    grace = GRACE if rule == WITH_GRACE else 0.0
    return ThesisEngine(robot, KNOWN, ThesisSettings(unmodelled=KNOWN_BOUND, grace=grace))


def _isolate(robot: RobotModel, true: tuple[str, ...], rule: str, scenario: Scenario) -> Isolation:
    """Run one combination of faults until the bank has said what it says first."""
    engine = _engine(robot, rule)
    run(scenario, engine, until=lambda: any(e.stage == "isolation" for e in engine.events))
    said = [e for e in engine.events if e.stage == "isolation"]
    if not said:
        return Isolation(true, rule, "none", (), 0, None)
    first = said[0]
    order = [e.name for e in KNOWN]
    named = tuple(sorted({t.effect.name for t in first.faults}, key=order.index))
    survivors = len(first.alternatives) + 1 if first.verdict in {"unique", "ambiguous"} else 0
    return Isolation(
        true, rule, str(first.verdict), named, survivors, first.time - min(f.start for f in scenario.faults)
    )
