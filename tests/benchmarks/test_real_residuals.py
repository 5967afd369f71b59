"""Known effects on real residuals: what is put into a log is what a comparison sees, and can be taken out again."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from benchmarks.measured_logs.folder import are_there
from benchmarks.real_residuals.answers import Named, differences, label_of, of_discovery
from benchmarks.real_residuals.bases import Base, planned_bases
from benchmarks.real_residuals.cases import (
    COMPARE,
    FLOWS,
    GONE,
    MODEL,
    REPORTING,
    SAMPLE,
    SIZES,
    TUNING,
    UNCHANGED,
    planned,
)
from benchmarks.real_residuals.claims import LEAST_PAIRS, PARTS
from benchmarks.real_residuals.draws import OF_THE_MOTOR, RECIPES, Place, drawn
from benchmarks.real_residuals.failures import failed
from benchmarks.real_residuals.filtered import FilteredLog, rms
from benchmarks.real_residuals.flows import FLOW, Question
from benchmarks.real_residuals.insertion import Insertion
from benchmarks.real_residuals.outcome import Outcome
from benchmarks.real_residuals.page import page
from benchmarks.real_residuals.pairs import known_pairs, pairs, repeated
from benchmarks.real_residuals.recordings import data_folder
from benchmarks.real_residuals.repeats import Repeat, agree, compared, planned_repeats
from benchmarks.real_residuals.sizing import NoSizeError, share, sized, telling
from benchmarks.real_residuals.trial import judged, logs_of
from benchmarks.real_residuals.variants import Variant, varied
from cdia_pin import Dynamics, discover, load_robot
from cdia_pin.discovery import compare
from cdia_pin.effects import EFFECTS, Term, parse_term
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.regression.experiment import Experiment
from tests.made_logs import make

ROBOT = load_robot("ur5")
FEASIBLE = {"encoder_offset": 0.02}  # [1], near its balance an arm hardly feels where it is


@pytest.fixture(scope="module")
def along() -> FilteredLog:
    """A log in which nothing is missing."""
    return FilteredLog.of(make(ROBOT, seed=3).log, ROBOT)


def term_of(effect: str, along: FilteredLog, size: float = 0.1) -> Term:
    return drawn(effect, FEASIBLE.get(effect, size), along, along, seed=7)


def residual(along: FilteredLog, log: Log, term: Term | None = None) -> np.ndarray:
    """What a model leaves of a log, filtered as `along` is, (K, n)."""
    same = Conditioning(cutoff=along.segment.motion.cutoff)
    model = Dynamics(ROBOT, (term,) if term else ())
    return Experiment.of(ROBOT, [condition(log, ROBOT, same)]).predict(model).residual


# ---------------------------------------------------------------- insertion


@pytest.mark.parametrize("effect", RECIPES)
def test_an_inserted_effect_is_what_the_residual_changes_by(effect: str, along: FilteredLog) -> None:
    put, motion = Insertion(term_of(effect, along), along), along.segment.motion
    changed = residual(along, put.into(along.log)) - residual(along, along.log)
    # as measured torques are
    expected = motion.compared(zero_phase(put.torque(), motion.record["motion_cutoff"], motion.rate))
    assert rms(changed - expected).max() < 0.02 * rms(expected).max()


@pytest.mark.parametrize("effect", RECIPES)
def test_the_model_with_the_effect_lacks_nothing(effect: str, along: FilteredLog) -> None:
    """The sign is the package's: M q̈ + nle = τ + f."""
    term = term_of(effect, along)
    log, nothing = Insertion(term, along).into(along.log), residual(along, along.log)
    before, after = (residual(along, log, t) - nothing for t in (None, term))
    # what the filter blurs where a friction turns round is no part of a comparison
    joints = list(term.effect.acts_on(ROBOT))
    clear = along.experiment.without_rest_of([term.effect]).moving[:, joints].all(axis=1)
    assert rms(after[clear]).max() < 0.05 * rms(before[clear]).max()


@pytest.mark.parametrize("effect", RECIPES)
def test_what_was_put_in_can_be_taken_out(effect: str, along: FilteredLog) -> None:
    put = Insertion(term_of(effect, along), along)
    log = along.log
    back = put.out_of(put.into(log))
    inner = np.s_[50:-50] if effect == "effort_delay" else np.s_[:]  # a delay knows nothing beyond the ends
    tolerance = 1e-3 if effect == "effort_delay" else 1e-12  # and interpolates
    scale = np.abs(log.effort).max()
    np.testing.assert_allclose(back.effort[inner], log.effort[inner], atol=tolerance * scale)
    np.testing.assert_allclose(back.position, log.position, atol=1e-12)


def test_a_body_is_the_arm_with_and_without_it(along: FilteredLog) -> None:
    """The rigid bodies agree with the effect's regressor, which is other code."""
    term = term_of("payload", along)
    np.testing.assert_allclose(
        Insertion(term, along).torque(), term.torque(along.state), atol=1e-9, rtol=1e-9
    )


def test_a_gain_divides_the_torque_and_nothing_else(along: FilteredLog) -> None:
    term = parse_term("actuator_gain@elbow_joint: gain=0.25")
    log = Insertion(term, along).into(along.log)
    j = ROBOT.joint_index("elbow_joint")
    np.testing.assert_allclose(log.effort[:, j] * 1.25, along.log.effort[:, j])
    others = np.arange(ROBOT.n) != j
    assert (log.effort[:, others] == along.log.effort[:, others]).all()


def test_a_delay_makes_the_torque_late(along: FilteredLog) -> None:
    term = parse_term("effort_delay: delay=0.02")
    log = Insertion(term, along).into(along.log)  # 100 Hz, so two samples
    np.testing.assert_allclose(log.effort[2:], along.log.effort[:-2], atol=1e-9)


# ---------------------------------------------------------------- sizes and draws


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("effect", ["coulomb_friction", "payload", "actuator_gain", "stribeck_friction"])
def test_an_effect_has_the_size_that_was_asked_for(effect: str, size: int, along: FilteredLog) -> None:
    assert share(term_of(effect, along, size / 100), along) == pytest.approx(size / 100, rel=0.02)


def test_an_encoder_that_is_far_off_is_refused(along: FilteredLog) -> None:
    with pytest.raises(NoSizeError, match="cannot have 1000%"):
        sized(parse_term("encoder_offset@elbow_joint: offset=0.01"), 10.0, along)


def test_a_draw_is_the_same_each_time_and_another_with_another_seed(along: FilteredLog) -> None:
    one, again, other = (drawn("position_ripple", 0.1, along, along, seed) for seed in (1, 1, 2))
    assert one == again != other


def test_a_link_is_felt_on_its_own_joint(along: FilteredLog) -> None:
    """A body on the axis of a joint is the same torque on the link before."""
    for seed in range(4):
        term = drawn("link_inertia", 0.1, along, along, seed)
        (joint,) = term.effect.scope
        j = ROBOT.joint_index(joint)
        torque = Insertion(term, along).torque()
        assert along.size(torque)[j] >= 0.05 * along.torque_rms[j]
        assert 0 < j < ROBOT.n - 1


def test_a_joint_at_rest_gets_no_effect(along: FilteredLog) -> None:
    log = along.log
    still = log.position.copy()
    still[:, 1:] = still[0, 1:]
    resting = FilteredLog.of(replace(log, position=still), ROBOT)
    terms = [drawn("torque_offset", 0.1, resting, along, seed) for seed in range(4)]
    assert {t.label for t in terms} == {"torque_offset@shoulder_pan_joint"}


def test_a_payload_is_as_large_as_its_mass_and_friction_as_its_parameters(along: FilteredLog) -> None:
    assert telling(term_of("payload", along), along) == ("mass",)
    assert telling(term_of("coulomb_friction", along), along) == ("level",)


def test_every_recipe_makes_its_own_effect(along: FilteredLog) -> None:
    at = Place(along, "elbow_joint", np.random.default_rng(1))
    assert {name: recipe(at).effect.name for name, recipe in RECIPES.items()} == {n: n for n in RECIPES}
    assert set(RECIPES) | {"base_tilt", "tool_wrench", "viscous_medium", "unknown", "expression"} <= set(
        EFFECTS
    )


# ---------------------------------------------------------------- answers


def test_a_discovery_names_what_was_inserted_into_an_exact_log(along: FilteredLog) -> None:
    term = parse_term("coulomb_friction@elbow_joint: level=3")
    found = discover(Dynamics(ROBOT), Insertion(term, along).into(along.log))
    (named,) = of_discovery(found)
    assert named.label == term.label
    assert named.values["level"] == pytest.approx(3.0, rel=0.02)


def test_a_body_on_the_last_link_is_a_payload_and_a_whole_arm_has_no_joints() -> None:
    last = {"effect": "link_inertia", "joints": [ROBOT.tool_joint]}
    assert label_of(last, ROBOT) == label_of({"effect": "payload", "joints": list(ROBOT.joints)}, ROBOT)
    assert label_of({"effect": "coulomb_friction", "joints": ["elbow_joint"]}, ROBOT).endswith("@elbow_joint")
    shared = {"effect": "coupled_friction", "joints": ["elbow_joint", "shoulder_lift_joint"]}
    assert label_of(shared, ROBOT) == "coupled_friction@shoulder_lift_joint+elbow_joint"


def test_a_descriptive_effect_does_not_count_as_named() -> None:
    mass = {"mass": {"value": 1.0, "unit": "kg", "ci95": [0.5, 1.5]}}
    entry = {"effect": "payload", "joints": list(ROBOT.joints), "parameters": mass, "group": "bodies"}
    entries = [{**entry, "confidence": c} for c in ("established", "likely", "descriptive")]
    found = SimpleNamespace(model=Dynamics(ROBOT), to_dict=lambda: {"effects": entries})
    named = of_discovery(found)
    assert [n.confidence for n in named] == ["established", "likely"]
    assert (named[0].group, named[0].intervals) == ("bodies", {"mass": (0.5, 1.5)})


COULOMB = Named("coulomb_friction@a", "", "", {"level": 1.0}, {"level": (0.9, 1.1)})


def test_two_discoveries_differ_by_what_is_new_gone_or_moved() -> None:
    other = replace(COULOMB, label="payload", values={"mass": 2.0}, intervals={})
    near = replace(COULOMB, values={"level": 1.05}, intervals={"level": (0.95, 1.15)})
    far = replace(COULOMB, values={"level": 2.0}, intervals={"level": (1.9, 2.1)})
    assert differences([COULOMB], [near]) == ()
    (moved,) = differences([COULOMB], [far])
    assert moved.values["level"] == pytest.approx(1.0)
    assert moved.intervals["level"][0] == pytest.approx(1 - np.hypot(0.1, 0.1))
    assert [n.label for n in differences([], [other])] == ["payload"]
    assert differences([other], [])[0].values == {"mass": -2.0}


def test_parameters_agree_within_both_intervals_together() -> None:
    far = replace(COULOMB, values={"level": 1.2}, intervals={"level": (1.1, 1.3)})
    assert agree(COULOMB, far) == [False]
    assert agree(COULOMB, replace(COULOMB, values={"level": 1.14}, intervals={"level": (1.04, 1.24)})) == [
        True
    ]


def test_two_logs_are_alike_in_the_names_that_both_establish(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.real_residuals.repeats._carried", lambda *_: 0.1)
    case = planned_repeats()[0]
    likely = replace(COULOMB, label="payload", confidence="likely")
    one, other = (
        Base(r.id, r.id, r.arm, True, named)
        for r, named in ((case.one, (COULOMB, likely)), (case.other, (COULOMB,)))
    )
    found = compared(case, one, other)
    assert (found.alike, found.within, found.compared, found.failure) == (1.0, 1, 1, "")
    failing = compared(case, one, replace(other, failure="PanicException"))
    assert (failing.alike, failing.failure) == (0.0, "PanicException")


# ---------------------------------------------------------------- logs recorded otherwise


@pytest.mark.parametrize("variant", Variant)
def test_a_log_recorded_otherwise_says_the_same_of_the_arm(variant: Variant) -> None:
    log = make(ROBOT, lambda q, v, a: 2.0 * np.sin(q), seed=4, rate=200.0).log
    one, other = (compare(Dynamics(ROBOT), x).rms for x in (log, varied(log, variant)))
    np.testing.assert_allclose(other, one, rtol=0.03)  # the samples that are compared are others


# ---------------------------------------------------------------- the plan


def test_draws_for_tuning_and_for_reporting_are_others() -> None:
    tuning, reporting = (planned(s) for s in (TUNING, REPORTING))
    assert not {c.seed for c in tuning} & {c.seed for c in reporting}
    assert {c.id.removeprefix(TUNING) for c in tuning if c.flow == COMPARE and not c.variant} == {
        c.id.removeprefix(REPORTING) for c in reporting if c.flow == COMPARE and not c.variant
    }


def test_every_effect_is_compared_at_every_size_and_there_are_enough_unchanged_pairs() -> None:
    cases = planned(REPORTING)
    assert len(cases) == len({c.id for c in cases})
    compared = [c for c in cases if c.flow == COMPARE and not c.variant]
    for pair in (p for p in pairs() if p.takes_effects):
        seen = {(c.effect, c.size) for c in compared if c.pair == pair and c.size}
        asked = set(RECIPES) - (OF_THE_MOTOR if pair.arm == "kuka_lwr4" else {"bearing_friction"})
        assert seen == {(e, s) for e in asked for s in SIZES}
    assert sum(c.effect == UNCHANGED for c in compared) >= LEAST_PAIRS
    assert {c.flow for c in cases} == set(FLOWS)
    assert {c.pair.arm for c in planned(REPORTING, every=SAMPLE)} == {c.pair.arm for c in cases}


def test_a_model_is_asked_the_same_draws_as_a_comparison() -> None:
    cases = planned(REPORTING)
    compared = {c.draw for c in cases if c.flow == COMPARE}
    assert {c.draw for c in cases if c.flow == MODEL} <= compared


def test_what_is_gone_is_asked_with_the_sides_exchanged(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    level = {"level": {"value": -2.0, "unit": "N·m", "ci95": [-2.2, -1.9]}}
    change = {"effect": "coulomb_friction", "joints": ["elbow_joint"], "difference": level}

    def what_changed(model: Dynamics, before: Log, after: Log) -> SimpleNamespace:
        asked.append((before, after))
        return SimpleNamespace(model=model, verdict="changed", to_dict=lambda: {"changes": [change]})

    monkeypatch.setattr("benchmarks.real_residuals.flows.what_changed", what_changed)
    before, after = (make(ROBOT, seed=seed).log for seed in (1, 2))
    (named,) = FLOW[GONE](Question(ROBOT, before, after)).named
    ((first, last),) = asked
    assert first is after
    assert last is before
    assert (named.values, named.intervals) == ({"level": 2.0}, {"level": (1.9, 2.2)})


def test_what_is_repeated_is_discovered_too() -> None:
    logs = {b.recording for b in planned_bases()}
    assert {r for two in repeated() for r in two} <= logs


# ---------------------------------------------------------------- outcomes and the page

FOUND = Outcome(
    id="reporting/x/compare",
    plain="reporting/x/compare",
    draw="reporting/x",
    arm="ur5",
    effect="coulomb_friction",
    size=25,
    flow=COMPARE,
    truth="coulomb_friction@a",
    named=(COULOMB,),
    verdict="changed",
    seconds=1.0,
)
NOTHING = replace(FOUND, effect=UNCHANGED, size=0, truth="", named=(), id="n", plain="n", draw="n")


def test_an_outcome_is_a_line_and_comes_back() -> None:
    one = judged(FOUND, COULOMB, {"level": 1.05})
    assert Outcome.from_json(one.to_json()) == one
    base = Base("panda/exciting", "panda/exciting", "panda", True, (COULOMB,), heldout=0.1, seconds=1.0)
    assert Base.from_json(base.to_json()) == base
    repeat = Repeat("a and b", "ur5", 1, 1, 1, 2, (0.1, 0.2))
    assert Repeat.from_json(repeat.to_json()) == repeat
    assert repeat.alike == 0.5


def test_an_answer_is_held_against_the_truth() -> None:
    one = judged(FOUND, COULOMB, {"level": 1.25})
    assert one.errors["level"] == pytest.approx(0.2)
    assert one.held == {"level": False}
    assert [o.answer for o in (FOUND, replace(FOUND, truth="payload"), replace(FOUND, named=()))] == [
        "exact",
        "other",
        "nothing",
    ]
    assert NOTHING.exact
    assert not replace(NOTHING, failure="PanicException: no").exact


def test_a_panic_is_a_line_and_an_interruption_is_not() -> None:
    class Panic(BaseException):
        pass

    assert failed(Panic("solver\nsecond line")) == "Panic: solver"
    with pytest.raises(KeyboardInterrupt):
        failed(KeyboardInterrupt())


def test_the_page_says_what_is_met_and_from_which_draws() -> None:
    missed = replace(
        FOUND, named=(), id="reporting/y/compare", plain="reporting/y/compare", draw="reporting/y"
    )
    by_model = replace(missed, flow=MODEL, id="reporting/y/model", plain="reporting/y/model")
    other = replace(FOUND, variant="resampled", id="reporting/x/compare/resampled", named=())
    hand = Named("payload", "", "", {"mass": -0.7}, {"mass": (-0.8, -0.6)})
    base = Base("panda/exciting", "panda/exciting", "panda", True, (hand,), "explained", 0.08, "", 3.0)
    text = page([FOUND, missed, by_model, other, NOTHING], [base], [], "command", REPORTING, whole=False)
    assert "suite *reporting*" in text
    assert "effects of 25 %: exactly the effect is named | ≥ 85% | 50\u00a0% (1/2) | 2 | **NOT met**" in text
    assert (
        "25 %: exactly the effect, less those of `compare A B` on the same cases | ≥ −5 points | +0 points"
        in text
    )
    assert "gives the same names | ≥ 95% | 0.00\u00a0% (0/1) | 1 | **NOT met**" in text
    assert "| -0.76 ± 0.1 kg | −0.700 ± 0.10 kg | 1 | yes |" in text
    assert "`reporting/y`" in text
    assert all(p.claims for p in PARTS)


# ---------------------------------------------------------------- the measured logs

measured = pytest.mark.skipif(not are_there(data_folder()), reason="the measured logs are absent")


@measured
def test_every_log_of_the_plan_is_there() -> None:
    logs = {r for pair in (*pairs(), *known_pairs()) for r in (pair.before, pair.after)}
    logs |= {b.recording for b in planned_bases()}
    assert not [r.id for r in logs if not (data_folder() / r.arm / f"{r.file}.csv").is_file()]


@measured
def test_a_measured_log_keeps_its_residual_and_gets_the_effect() -> None:
    (case,) = (
        c
        for c in planned(TUNING, ["double_pendulum"], [25], [COMPARE])
        if c.draw.endswith("swing_1 → swing_2/viscous_friction 25 %") and not c.variant
    )
    before, after, truth = logs_of(case)
    untouched = case.pair.after.read()
    assert (before.source, after.source) == ("double_pendulum/swing_1", "double_pendulum/swing_2")
    (value,) = truth.values.values()
    along = FilteredLog.of(untouched, case.pair.before.robot)
    j = after.joints.index(truth.label.partition("@")[2])
    f = untouched.effort[:, j] - after.effort[:, j]
    time = along.state.time
    speed = CubicSpline(time, along.state.v[:, j])(np.clip(untouched.time, time[0], time[-1]))
    np.testing.assert_allclose(f, -value * speed, atol=1e-9)  # M q̈ + nle = τ + f
