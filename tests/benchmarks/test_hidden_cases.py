"""A sample of the benchmark of hidden effects: every suite, every noise, all arms; and the parts that judge it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from benchmarks.hidden_effects.bounds import bound_of_conditioned, bound_of_log
from benchmarks.hidden_effects.case import NOISES, POOR, Case
from benchmarks.hidden_effects.cases import ARMS, OUTSIDE, SUITES, VOCABULARY, planned
from benchmarks.hidden_effects.claims import PARTS
from benchmarks.hidden_effects.drawing import drawn, recorded
from benchmarks.hidden_effects.oracle import noise_floor, sight_outside, sights, unordered
from benchmarks.hidden_effects.outcome import Outcome
from benchmarks.hidden_effects.page import page
from benchmarks.hidden_effects.truth import label_of, true_model
from benchmarks.plant import CLEAN, Fault, Fourier, MujocoPlant, cache
from cdia_pin.discovery import compare, discover
from cdia_pin.dynamics import Dynamics


@pytest.fixture(autouse=True)
def cache_elsewhere(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "HOME", tmp_path_factory.getbasetemp() / "cache" / "plant")


# ---------------------------------------------------------------- the plan


def test_cases_have_names_of_their_own_and_there_are_enough_of_each_kind() -> None:
    cases = planned()
    assert len(cases) == len({c.id for c in cases}) >= 500
    singles = [c for c in cases if c.suite == "single"]
    assert {(c.effects[0], c.arm, c.noise) for c in singles} == {
        (e, a, n) for e in VOCABULARY for a in ARMS for n in NOISES
    }
    for effect in VOCABULARY:
        shares = {c.shares[0] for c in singles if c.effects == (effect,)}
        assert min(shares) < 0.2 < max(shares)
    assert {c.excitation for c in cases if c.suite == "poor"} == set(POOR)
    assert sum(c.suite == "clean" for c in cases) >= 100
    assert {c.effects[0] for c in cases if c.suite == "outside"} == set(OUTSIDE)


def test_a_sample_is_part_of_the_plan_and_holds_every_suite() -> None:
    sample = planned(every=8)
    assert {c.id for c in sample} < {c.id for c in planned()}
    assert {c.suite for c in sample} == set(SUITES)


def test_a_case_is_drawn_the_same_each_time() -> None:
    case = next(c for c in planned() if c.suite == "triple" and c.arm == "ur5")
    (_, one), (_, two) = drawn(case), drawn(case)
    assert one == two
    assert [f.effect for f in one.faults] == list(case.effects)


# ---------------------------------------------------------------- the truth and the oracle


@pytest.mark.parametrize("effect", [*VOCABULARY, "links"])
def test_the_true_model_lacks_nothing(effect: str) -> None:
    """What the plant hides, and what the package is told that it is, are one thing."""
    case = Case("single", "ur5", (effect,), (0.3,), "white")
    if effect == "links":
        case = Case("model error", "ur5", (), (), "white", model_error=0.05)
    plant, scenario = drawn(case)
    log = replace(scenario, noise=CLEAN, duration=6.0).run(plant).log
    true = true_model(plant, scenario.faults)
    before = compare(Dynamics(plant.robot), log).rms
    # The sum of two joints' speeds reverses where neither does, and the filter blurs its sign.
    most = 0.1 if effect == "coupled_friction" else 0.02
    assert (noise_floor(true, log) < most * before.max()).all()


def test_the_oracle_tells_what_a_good_motion_shows_and_confuses_what_one_speed_hides() -> None:
    good = Case("single", "ur5", ("viscous_friction",), (0.1,), "white")
    plant, scenario = drawn(good)
    (sight,) = sights(
        true_model(plant, scenario.faults), scenario.faults, recorded(good, scenario.run(plant))
    )
    assert sight.told
    hidden = replace(good, suite="alike", excitation="one way")
    plant, scenario = drawn(hidden)
    (sight,) = sights(
        true_model(plant, scenario.faults), scenario.faults, recorded(hidden, scenario.run(plant))
    )
    assert sight.confusable
    assert sight.rival.endswith(str(scenario.faults[0].joint))


def test_the_oracle_knows_what_is_outside_in_name_only() -> None:
    """A dead zone that a torque never crosses is an offset; a cubic spring is like nothing else."""
    plant = MujocoPlant("double_pendulum")
    still = Fourier(amplitude=0.05)
    run = plant.run(
        [Fault("torque_deadzone", joint="joint1", width=0.02)], motion=still, duration=12.0, seed=3
    )
    assert np.abs(run.truth.effort[:, 0]).min() > 0.02  # [N·m]
    sight = sight_outside(run, plant.robot)
    assert sight.alone > 100 > sight.apart
    run = plant.run([Fault("cubic_spring", joint="joint1", stiffness=0.2)], duration=12.0)
    assert sight_outside(run, plant.robot).told


def test_bounds_are_those_of_a_regression_in_white_noise() -> None:
    """For an offset in white noise the bound is σ/√N, and the conditioning keeps what is slow."""
    plant = MujocoPlant("double_pendulum")
    run = plant.run([Fault("torque_offset", joint="joint1", offset=0.1)], duration=12.0)
    true = true_model(plant, run.faults)
    bound = bound_of_log(true, true.terms[0], run, CLEAN)
    assert bound[0] == pytest.approx(run.noise_std[0] / np.sqrt(len(run.log.time)), rel=1e-6)
    kept = bound_of_conditioned(true, true.terms[0], run, CLEAN)
    assert bound[0] < kept[0] < 1.15 * bound[0]


# ---------------------------------------------------------------- outcomes and figures

FOUND = Outcome(
    id="ur5/single/x",
    suite="single",
    arm="ur5",
    noise="white",
    excitation="good",
    shares=(0.1,),
    hidden=("coupled_friction@a+b",),
    found=("coupled_friction@b+a",),
    confusable=(),
    verdict="explained",
    mean_over_floor=1.01,
    over_floor=1.02,
)


def test_an_outcome_is_a_line_and_comes_back() -> None:
    assert Outcome.from_json(FOUND.to_json()) == FOUND
    bare = replace(FOUND, mean_over_floor=float("nan"))
    assert Outcome.from_json(bare.to_json()).to_json() == bare.to_json()


def test_exact_means_neither_more_nor_fewer() -> None:
    assert FOUND.exact
    assert not replace(FOUND, found=(*FOUND.found, "payload")).exact
    assert not replace(FOUND, found=()).exact
    assert replace(FOUND, suite="model error", found=(*FOUND.found, "payload", "link_inertia@a")).exact


def test_a_set_holds_the_truth_only_if_it_has_more_than_one_member() -> None:
    assert not FOUND.holds_truth
    other = replace(FOUND, found=("payload",), confusable=("viscous_friction@a", "coupled_friction@a+b"))
    assert other.holds_truth
    assert not replace(other, confusable=("viscous_friction@a",)).holds_truth


def test_the_page_says_what_is_met_and_which_cases_fell_short() -> None:
    missed = replace(FOUND, id="ur5/single/y", found=("payload",))
    text = page([FOUND, missed], [], [], "python -m benchmarks.hidden_effects", whole=False)
    assert "50\u00a0% (1/2) | 2 | **NOT met**" in text
    assert "`ur5/single/y`" in text
    assert "`ur5/single/x`" not in text
    assert all(sum(p.chosen(replace(FOUND, suite=s)) for p in PARTS) == 1 for s in SUITES)


# ---------------------------------------------------------------- the sample

SAMPLE = [c for c in planned(every=60) if c.suite != "alike"]
NOT_YET = {  # steps of an encoder beat with the samples on even motion: called a structure
    "z1/clean/nothing/quantised/one way/9",
}


@pytest.mark.parametrize("case", SAMPLE, ids=lambda c: c.id)
def test_the_discovery_answers_as_expected(case: Case, request: pytest.FixtureRequest) -> None:
    if case.id in NOT_YET:
        request.applymarker(pytest.mark.xfail(reason="docs/results-discovery.md, falls short", strict=True))
    plant, scenario = drawn(case)
    found = discover(Dynamics(plant.robot), recorded(case, scenario.run(plant)))
    named = {unordered(s.term.label) for s in found.steps}
    hidden = {
        unordered(str(f)) if case.suite == "outside" else unordered(label_of(f)) for f in scenario.faults
    }
    if case.suite == "outside":
        assert found.verdict == "unexplained"
    elif case.suite == "model error":
        assert hidden <= named
    elif case.suite == "poor":
        doubts = {unordered(e.label) for s in found.steps for c in s.confusions for e in c.effects}
        assert hidden <= named | doubts or found.verdict == "unexplained"
    else:
        assert named == hidden
    if case.suite == "clean":
        assert found.verdict == "nothing-missing"
