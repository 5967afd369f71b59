"""What the studies claim of accommodation and isolation is what they measure."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.campaigns import thesis_study as study
from cdia_pin.campaigns.scara_run import (
    AMPLITUDE,
    FREQUENCY,
    Fault,
    Job,
    Scenario,
    desired,
    run,
    run_together,
)
from cdia_pin.campaigns.thesis_presets import PRESETS, UNMODELLED, literal, physical
from cdia_pin.diagnosis.thesis import ThesisEngine
from cdia_pin.effects import ActuatorGain
from cdia_pin.errors import ModelError
from cdia_pin.robot import scara
from cdia_pin.viewers.study_figures import thesis_pictures
from cdia_pin.viewers.study_report import failures, study_page


@pytest.fixture(scope="module")
def arm():
    return load_robot("scara")


def short(scenario, early=1.5, duration=4.5):
    """A scenario brought forward, at 500 Hz."""
    faults = tuple(replace(f, start=f.start - early) for f in scenario.faults)
    return replace(scenario, faults=faults, duration=duration, tick=2e-3)


def test_the_desired_motion_is_a_sine_and_its_derivatives():
    t, h = 0.7, 1e-5
    q, v, a = desired(t)
    np.testing.assert_allclose(q, AMPLITUDE * np.sin(FREQUENCY * t))
    np.testing.assert_allclose(v, (desired(t + h)[0] - desired(t - h)[0]) / (2 * h), rtol=1e-8)
    np.testing.assert_allclose(a, (desired(t + h)[1] - desired(t - h)[1]) / (2 * h), rtol=1e-8)


def test_the_plant_keeps_its_energy_without_torque(monkeypatch):
    monkeypatch.setattr("cdia_pin.campaigns.scara_run.STIFFNESS", np.zeros(4))
    monkeypatch.setattr("cdia_pin.campaigns.scara_run.DAMPING", np.zeros(4))
    off = Fault(ActuatorGain("joint1"), np.full((4, 1), -1.0), 0.0)  # no torque arrives
    moved = run(Scenario((off,), np.zeros(4), duration=1.0))
    kinetic = 0.5 * np.einsum("ni,nij,nj->n", moved.v, scara.mass_matrix(moved.q), moved.v)
    energy = kinetic + 30.0 * 9.8 * moved.q[:, 3]
    assert np.ptp(energy) < 1e-8 * kinetic.max()


def test_arms_that_run_together_move_as_if_alone(arm):
    preset = physical(arm)
    scenarios = [short(s, duration=1.5 + 0.2 * i) for i, s in enumerate(preset.cases.values())]
    scenarios[1] = replace(scenarios[1], substeps=2)

    def jobs():
        engines = [ThesisEngine(arm, settings=preset.settings), None, None, None]
        return [Job(s, e) for s, e in zip(scenarios, engines, strict=True)]

    for together, job in zip(run_together(jobs()), jobs(), strict=True):
        alone = run(job.scenario, job.engine)
        np.testing.assert_array_equal(together.time, alone.time)
        np.testing.assert_allclose(together.q, alone.q, atol=1e-10)
        np.testing.assert_allclose(together.effort, alone.effort, atol=1e-7)
        assert together.stages == alone.stages
        assert [e.time for e in together.events] == [e.time for e in alone.events]


@pytest.mark.parametrize(
    ("case", "factor"), [("30 % torque loss", 15.0), ("Coulomb friction", 3.0), ("viscous friction", 3.0)]
)
def test_physical_faults_are_accommodated(arm, case, factor):
    preset = physical(arm)
    found = study.run_case(case, short(preset.cases[case]), ThesisEngine(arm, settings=preset.settings))
    rms = found.tracking()
    assert (rms["accommodated"] < rms["faulty"] / factor).all()
    assert (rms["healthy"] < rms["faulty"]).all()
    assert 0 < found.detected_after < 0.05


def test_the_printed_component_fault_is_not_accommodated_by_the_printed_gains(arm):
    preset = literal(arm)
    case = "component fault alone"
    found = study.run_case(
        case, short(preset.cases[case], duration=3.5), ThesisEngine(arm, settings=preset.settings)
    )
    rms = found.tracking()
    assert (rms["accommodated"][:2] > 0.5 * rms["faulty"][:2]).all()
    assert (rms["healthy"][:2] < 0.2 * rms["faulty"][:2]).all()


def test_a_joint_without_better_tracking_is_named():
    def tracked(error):
        return SimpleNamespace(tracking=lambda since: np.array(error))

    case = study.Case("x", 1.0, 3.0, tracked([0.0, 0.0]), tracked([1.0, 2.0]), tracked([0.5, 2.5]))
    assert case.worse == (1,)
    (sentence,) = failures(("shoulder", "elbow"), [case])
    assert "Not accommodated, x: elbow (2.5 against 2 rad" in sentence


def test_the_unmodelled_torque_stays_within_the_known_bound():
    assert (np.array(physical(load_robot("scara")).settings.unmodelled) > UNMODELLED).all()
    printed = literal(load_robot("scara"))
    size = next(iter(printed.cases.values())).unmodelled
    assert (size < np.array(printed.settings.unmodelled)).all()


def test_an_unknown_preset_is_refused():
    with pytest.raises(ModelError, match="did you mean physical"):
        study.thesis_study(("phisical",))


@pytest.fixture(scope="module")
def small(arm):
    """The whole study on a few short runs."""
    with pytest.MonkeyPatch.context() as patch:
        one = physical(arm)
        cases = {name: short(one.cases[name], duration=2.8) for name in ("30 % torque loss",)}
        patch.setitem(PRESETS, "physical", lambda robot: replace(one, cases=cases))
        mixtures = [
            (true, rule, replace(scenario, tick=2e-3))
            for true, rule, scenario in study._mixtures()
            if rule == study.LearningRule.NO_GRACE and len(true) == 1
        ]
        patch.setattr(study, "_mixtures", lambda: iter(mixtures))
        scenario = study._scenario
        patch.setattr(study, "_scenario", lambda true: short(scenario(true), duration=2.8))
        told = []
        found = study.thesis_study(("physical",), progress=lambda sentence, share: told.append(share))
        return found, told


def test_progress_runs_from_zero_to_one(small):
    _, told = small
    assert told[0] == 0.0
    assert told == sorted(told)
    assert told[-1] < 1.0
    assert len(told) > 5


def test_as_printed_nothing_is_isolated(small):
    found, _ = small
    assert len(found.isolations) == 3
    assert all(i.verdict == "unknown" and not i.isolated for i in found.isolations)


def test_figures_and_page_are_consistent(small, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("cdia_pin.viewers.study_figures.DPI", 30)
    found, _ = small
    pictures = list(thesis_pictures(found))
    assert len(pictures) == 6
    assert len({p.name for p in pictures}) == 6
    assert all(p.png.startswith(b"\x89PNG") for p in pictures)
    page = study_page(found, pictures, "cdia study thesis")
    assert page.count("<img ") == 6
    assert "http" not in page.replace("http-equiv", "")
    assert ":root" in page  # the style of the package's reports
    rms = found.cases["physical"][0].tracking()["accommodated"][0]
    assert f"{rms:.2g}" in page
    assert "0 of 3 combinations isolated" in page
