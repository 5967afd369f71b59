"""What changed between two logs: found on a plant that is not our model, and nothing where nothing did."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.plant import Fault, Fourier
from benchmarks.plant.sizes import Sizer
from cdia_pin import Dynamics, what_changed
from cdia_pin.changes import detection
from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.changes_result import Change
from cdia_pin.changes.common_structure import common_effects
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.interpretation import findings_of
from cdia_pin.changes.run_to_run import RunToRun
from cdia_pin.effects import LinkInertia, Payload, Term, parse_effect
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.selection.discovery_settings import ChangeSettings, DiscoverySettings, RunToRunSettings
from tests.hidden_plants import plant_of

SECONDS = 24.0
WRONG = tuple(  # the URDF is wrong in the same way before and after, and the drives have friction
    fault
    for joint, mass, inertia, level, coefficient in (
        ("shoulder_lift_joint", 0.3, 0.04, 3.0, 4.0),
        ("elbow_joint", -0.08, -0.05, 1.2, 1.5),
        ("wrist_1_joint", 0.04, 0.03, 0.05, 0.05),
    )
    for fault in (
        Fault("link_inertia", joint=joint, mass=mass, inertia=inertia),
        Fault("coulomb_friction", joint=joint, level=level),
        Fault("viscous_friction", joint=joint, coefficient=coefficient),
    )
)
OUTSIDE = (  # and has physics that the vocabulary does not know
    Fault("presliding", joint="elbow_joint", level=1.2, reach=0.1),
    Fault("speed_bump", joint="wrist_1_joint", level=0.05, speed=0.25, width=0.06),
)


FAR_OUTSIDE = (  # as much of it as measured arms have
    Fault("speed_bump", joint="shoulder_lift_joint", level=12.0, speed=0.3, width=0.12),
    Fault("speed_bump", joint="elbow_joint", level=6.0, speed=0.3, width=0.12),
    Fault("speed_bump", joint="wrist_1_joint", level=0.6, speed=0.4, width=0.12),
    Fault("presliding", joint="elbow_joint", level=8.0, reach=0.2),
)


def changed(before, after, seed=3, motion=None):
    """What changed between two logs of different motions."""
    plant = plant_of("ur5")
    logs = [
        plant.run(faults, motion=motion, duration=SECONDS, seed=s).log
        for faults, s in ((before, seed), (after, seed + 1000))
    ]
    return what_changed(Dynamics(plant.robot), *logs)


def the_only(found):
    (change,) = found.changes
    return change


def inside(term, name, value):
    k = [p.name for p in term.effect.parameters].index(name)
    low, high = term.ci95[k]
    return low < value < high


@pytest.mark.parametrize("common", [(), WRONG + OUTSIDE], ids=["clean", "wrong and outside"])
def test_nothing_changed_though_motion_and_noise_did(common):
    found = changed(common, common)
    assert found.verdict == "unchanged"
    torque = Sizer(plant_of("ur5"), Fourier(), SECONDS, 3).rms
    noise = 0.01 * np.maximum(torque, 0.02 * torque.max())  # of the plant, on each sample
    for j, joint in enumerate(found.model.robot.joints):
        assert found.bounds[joint].torque < max(0.2 * torque[j], noise[j])  # and more would have been seen


@pytest.mark.parametrize("seed", [5, 6])
def test_a_motion_that_is_driven_three_times_does_not_confirm_what_it_follows_by_chance(seed):
    common = (*WRONG, *FAR_OUTSIDE)
    assert changed(common, common, seed, Fourier(base=3 / SECONDS)).verdict == "unchanged"


def test_a_payload_is_distinguished_from_a_wrong_model():
    loaded = (*WRONG, Fault("payload", mass=1.5, com=(0.03, 0.01, 0.06), size=0.12))
    terms = [the_only(changed(WRONG, loaded, seed)).term for seed in range(3, 9)]
    for term in terms:
        assert term.label == "payload"
        assert term.values["mass"] == pytest.approx(1.5, rel=0.01)
    assert sum(inside(term, "mass", 1.5) for term in terms) >= 5  # one in twenty may miss


def test_a_tool_taken_off_is_a_payload_of_the_other_sign():
    change = the_only(changed((*WRONG, Fault("payload", mass=0.5, size=0.1)), WRONG))
    assert change.term.label == "payload"
    assert change.term.values["mass"] == pytest.approx(-0.5, rel=0.03)


def test_friction_that_grew_has_a_size_before_and_after():
    worn = [
        f.with_parameters({"level": 2.2}) if str(f) == "coulomb_friction@elbow_joint" else f for f in WRONG
    ]
    change = the_only(changed(WRONG, tuple(worn)))
    assert change.term.label == "coulomb_friction@elbow_joint"
    assert change.term.values["level"] == pytest.approx(1.0, rel=0.06)
    assert change.before == pytest.approx((1.2,), rel=0.1)
    assert change.growth == pytest.approx(1.0 / 1.2, rel=0.15)


def test_friction_that_falls_on_most_joints_is_a_warm_arm():
    every = [
        Fault(kind, joint=joint, **{name: size * share})
        for joint, size in zip(plant_of("ur5").joints, (3.0, 6.0, 3.0, 0.4, 0.4, 0.3), strict=True)
        for kind, name, share in (
            ("viscous_friction", "coefficient", 1.0),
            ("coulomb_friction", "level", 0.5),
        )
    ]
    warm = [f.with_parameters({k: 0.7 * v for k, v in f.parameters.items()}) for f in every]
    found = changed(tuple(every), tuple(warm))
    (finding,) = found.findings
    assert finding.kind == "warming"
    assert finding.values["median_growth"] == pytest.approx(-0.3, abs=0.03)
    assert len(finding.joints) >= 5


def test_logs_of_one_condition_on_both_sides_are_refused():
    from dataclasses import replace

    log = replace(plant_of("ur5").run((), duration=12.0, seed=5).log, condition="warm")
    with pytest.raises(LogError, match="different conditions"):
        what_changed(Dynamics(plant_of("ur5").robot), log, log)


# ------------------------------------------------------------------ the parts


def ripple(size, frequency=3.0):
    return (
        Fault("position_ripple", joint="wrist_1_joint", sine=size, cosine=0.5 * size, frequency=frequency),
    )


def test_a_ripple_that_both_logs_have_and_the_model_has_not_is_no_change():
    assert changed(ripple(2.0), ripple(2.0)).changes == ()


def test_a_ripple_that_both_logs_have_and_that_grew_is_a_change():
    grown = the_only(changed(ripple(2.0), ripple(4.0)))
    assert grown.term.label == "position_ripple@wrist_1_joint"
    assert grown.term.values["sine"] == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize(
    ("fault", "name", "size"),
    [
        (ripple(2.0, 14.0)[0], "sine", 2.0),
        (Fault("joint_spring", joint="elbow_joint", stiffness=12.0), "stiffness", 12.0),
    ],
    ids=["ripple", "spring"],
)
def test_what_was_there_before_and_is_gone_is_found_with_the_other_sign(fault, name, size):
    change = the_only(changed((*WRONG, fault), WRONG))
    assert change.term.label == str(fault)
    assert change.term.values[name] == pytest.approx(-size, rel=0.1)


def friction(*growth, after=0.5):
    """Friction of an arm whose joints differ by some shares; so much of the samples is of the logs after."""
    n = len(growth)
    joints, unknown = tuple(f"joint{k}" for k in range(n)), np.full(n, np.nan)
    return RunToRun(
        joints, np.ones(n), np.array(growth), unknown, np.ones(n), RunToRunSettings(), np.full(n, after)
    )


@pytest.mark.parametrize(
    ("growth", "kinds"),
    [
        ((-0.1, -0.05, -0.2, -0.05, 0.02, np.nan), ["warming"]),
        ((0.1, 0.05, 0.2), ["cooling"]),
        ((-0.1, -0.1, -0.1, -0.1, 0.1, 0.0), []),  # rises on one
        ((-0.5, -0.5, 0.0), []),  # wear of two
        ((-0.1, -0.1, -0.1, 0.0, 0.0, 0.0, 0.0), []),  # most stay
        ((-0.02,) * 6, []),
    ],
)
def test_friction_of_most_joints_in_one_direction_is_temperature(growth, kinds):
    assert [f.kind for f in findings_of([], friction(*growth))] == kinds


@pytest.mark.parametrize(("growth", "after"), [(0.8, 0.25), (4 / 7, 0.75), (2 / 3, 0.5)])
def test_growth_is_over_the_friction_before_however_long_the_logs_are(growth, after):
    # friction doubles: what both sides have in common is 1 + after of that before
    (finding,) = findings_of([], friction(*(growth,) * 3, after=after))
    assert "rose on all 3 joints by 100 % (median)" in finding.sentence


def test_friction_falls_by_no_more_than_all_of_it():
    (finding,) = findings_of([], friction(-2.5, -2.5, -2.5))
    assert "fell on all 3 joints by 100 % (median)" in finding.sentence


def test_joints_whose_friction_differs_little_are_not_said_to_stay():
    (finding,) = findings_of([], friction(-0.3, -0.3, -0.3, -0.03, 0.03, np.nan))
    assert (
        "on 3 of 6 joints by 26 % (median); on the others it differs by less than 4 %, or is not known"
        in finding.sentence
    )


@pytest.mark.parametrize("body", ["payload", "link_inertia@wrist_3_joint"])
def test_joints_that_carry_more_have_more_friction(body):
    term = Term(parse_effect(body), (1.0,) + (0.0,) * 9)
    change = Change(term, None, np.ones(3), 1.0)
    assert not findings_of([change], friction(0.1, 0.1, 0.1))


@pytest.mark.parametrize("growth", [1.9, 2.0, 2.05])
def test_where_hardly_any_friction_was_before_its_growth_is_a_lower_bound(growth):
    (finding,) = findings_of([], friction(growth, growth, growth))
    assert "rose on all 3 joints by at least 200 % (median)" in finding.sentence
    assert finding.values["median_growth"] == pytest.approx(2.0)


@pytest.mark.parametrize(("growth", "kinds"), [(0.1, []), (-0.1, ["warming"])])
def test_friction_that_rises_with_a_payload_is_no_temperature(ur5, growth, kinds):
    change = Change(Term(parse_effect("payload"), (2.0, *[0.0] * 9)), None, np.ones(ur5.n), 50.0)
    assert [f.kind for f in findings_of([change], friction(*[growth] * 6))] == kinds


def test_torques_that_all_come_later_are_said_to_be_the_recorders(ur5):
    def found(effect):
        change = Change(Term(parse_effect(effect), (0.012,)), None, np.ones(ur5.n), 50.0)
        return findings_of([change], friction(*[0.0] * 6))

    (finding,) = found("effort_delay")
    assert finding.kind == "recorder"
    assert "12 ms later" in finding.sentence
    assert found(f"effort_delay@{ur5.joints[0]}") == ()


def regression(rng, scale=np.inf):
    parts = [
        ColumnGroup({0: rng.standard_normal((80, 3)), 1: rng.standard_normal((80, 3))}, np.full(3, scale)),
        ColumnGroup({1: rng.standard_normal((80, 2))}, np.full(2, np.inf)),
    ]
    return parts, rng.standard_normal((80, 2))


def dense(parts):
    rows = [np.zeros((80, 5)), np.zeros((80, 5))]
    for j in (0, 1):
        rows[j][:, :3] = parts[0].columns[j]
    rows[1][:, 3:] = parts[1].columns[1]
    return np.vstack(rows)


def test_joints_that_share_parameters_are_one_least_squares_problem():
    parts, y = regression(np.random.default_rng(1))
    left, used = SharedRegression.of(parts, y, lambda j, x: x).residual()
    x = dense(parts)
    expected = y.T.ravel() - x @ np.linalg.lstsq(x, y.T.ravel())[0]
    np.testing.assert_allclose(left.T.ravel(), expected, atol=1e-8)
    assert used.sum() == pytest.approx(5)


def test_what_is_common_is_projected_away():
    """Frisch, Waugh and Lovell: the rest regressed on the rest gives the same parameters."""
    parts, y = regression(np.random.default_rng(2))
    shared = SharedRegression.of(parts, y, lambda j, x: x)
    gram = shared.beside(3)
    theta = np.linalg.solve(gram[:-1, :-1], gram[:-1, -1])
    np.testing.assert_allclose(theta, np.linalg.lstsq(dense(parts), y.T.ravel())[0][3:], atol=1e-8)


def test_parameters_far_beyond_their_prior_are_held_back():
    parts, y = regression(np.random.default_rng(3), scale=1e-3)
    _, used = SharedRegression.of(parts, y, lambda j, x: x).residual()
    assert used.sum() < 2.1


GAIN = (*WRONG, Fault("actuator_gain", joint="elbow_joint", gain=-0.25))


def test_what_may_be_nothing_is_no_change(monkeypatch):
    sized = detection.sized

    def unsure(found):
        return [t.with_intervals(1.1 * np.abs(t.theta)) for t in sized(found)]

    monkeypatch.setattr(detection, "sized", unsure)
    assert changed(WRONG, GAIN).changes == ()


@pytest.mark.parametrize(("unsure_alone", "named"), [(False, ["actuator_gain@elbow_joint"]), (True, [])])
def test_what_is_sure_only_beside_what_is_not_named_is_not_named(monkeypatch, unsure_alone, named):
    sized = detection.sized

    def friction_may_be_nothing(found):
        terms = sized(found)
        unsure = {"coulomb_friction", *(["actuator_gain"] if unsure_alone and len(terms) == 1 else [])}
        return [t.with_intervals(1.1 * np.abs(t.theta)) if t.effect.name in unsure else t for t in terms]

    monkeypatch.setattr(detection, "sized", friction_may_be_nothing)
    both = (*GAIN, Fault("coulomb_friction", joint="shoulder_pan_joint", level=8.0))
    assert [c.term.label for c in changed(WRONG, both).changes] == named


def only_likely(kind):
    """A confidence that is likely for one kind of effect, and established for all others."""

    def confidence(search, rest, one):
        likely = search.evidence.effects[one].effect.name == kind
        return Confidence.LIKELY if likely else Confidence.ESTABLISHED

    return confidence


def test_what_may_be_nothing_without_what_is_likely_is_likely_itself(monkeypatch):
    sized = detection.sized

    def opposite_alone(found):
        terms = sized(found)
        if len(terms) > 1:
            return terms
        return [t.with_theta(-np.array(t.theta)).with_intervals(t.half_widths) for t in terms]

    monkeypatch.setattr(ChangeSearch, "confidence", only_likely("coulomb_friction"))
    both = (*GAIN, Fault("coulomb_friction", joint="shoulder_pan_joint", level=8.0))
    said = {c.term.label: c.confidence for c in changed(WRONG, both).changes}
    assert said == {
        "actuator_gain@elbow_joint": "established",
        "coulomb_friction@shoulder_pan_joint": "likely",
    }
    monkeypatch.setattr(detection, "sized", opposite_alone)
    assert {c.confidence for c in changed(WRONG, both).changes} == {"likely"}


@pytest.mark.parametrize(
    ("wider", "named"), [(1.0, {"payload", "link_inertia@elbow_joint"}), (50.0, {"payload"})]
)
def test_a_likely_body_that_blurs_an_established_one_is_a_part_of_it(monkeypatch, wider, named):
    sized = detection.sized

    def blurred(found):
        terms = sized(found)
        both = len({t.effect.name for t in terms} & {"payload", "link_inertia"}) == 2
        return [
            t.with_intervals(
                (wider if both and t.effect.name == "payload" else 1.0) * np.array(t.half_widths)
            )
            for t in terms
        ]

    monkeypatch.setattr(ChangeSearch, "confidence", only_likely("link_inertia"))
    monkeypatch.setattr(ChangeSearch, "rivals", lambda search, chosen, one: [])
    monkeypatch.setattr(detection, "sized", blurred)
    bodies = (
        *WRONG,
        Fault("payload", mass=1.5),
        Fault("link_inertia", joint="elbow_joint", mass=1.0, inertia=0.1),
    )
    assert {c.term.label for c in changed(WRONG, bodies).changes} == named


def with_friction(**grown):
    """The wrong arm, whose elbow has more friction of some kinds."""

    def worn(fault):
        if fault.joint != "elbow_joint" or fault.effect not in grown:
            return fault
        sizes = {name: value + grown[fault.effect] for name, value in fault.parameters.items()}
        return Fault(fault.effect, joint=fault.joint, **sizes)

    return tuple(map(worn, WRONG))


@pytest.mark.parametrize("seed", [3, 4])
def test_friction_that_grew_alike_in_both_directions_is_plain(seed):
    """Before, it was called asymmetric friction, established, with both levels alike."""
    worn = with_friction(coulomb_friction=3.0, viscous_friction=4.0)
    changes = {c.term.label: c for c in changed(WRONG, worn, seed=seed).changes}
    assert set(changes) == {"coulomb_friction@elbow_joint", "viscous_friction@elbow_joint"}
    assert all(c.confidence == "established" for c in changes.values())
    assert changes["coulomb_friction@elbow_joint"].term.theta == pytest.approx((3.0,), rel=0.02)
    assert changes["viscous_friction@elbow_joint"].term.theta == pytest.approx((4.0,), rel=0.02)


@pytest.mark.parametrize(
    ("grown", "beside"),
    [
        ({"viscous_friction": 4.0}, Fault("torque_offset", joint="elbow_joint", offset=2.0)),
        ({"coulomb_friction": 3.0}, Fault("joint_spring", joint="elbow_joint", stiffness=5.0)),
        ({"coulomb_friction": 3.0}, Fault("actuator_gain", joint="elbow_joint", gain=-0.2)),
    ],
    ids=["viscous and offset", "coulomb and spring", "coulomb and gain"],
)
@pytest.mark.parametrize("seed", [7, 8])
def test_two_changes_of_a_joint_are_both_named(grown, beside, seed):
    """Before, an asymmetric friction found first stayed: it stood for both, or was dropped at the end.

    A spring of 5 N·m/rad then was one of 7.0, established, without the friction.
    """
    found = changed(WRONG, (*with_friction(**grown), beside), seed=seed)
    own = {f"{kind}@elbow_joint": size for kind, size in grown.items()}
    own[f"{beside.effect}@elbow_joint"] = next(iter(beside.parameters.values()))
    changes = {c.term.label: c.term for c in found.changes}
    assert set(changes) == set(own)
    for label, size in own.items():
        assert changes[label].theta[0] == pytest.approx(size, rel=0.02)


def test_a_level_of_its_own_each_way_is_asymmetric_friction():
    grown = with_friction(coulomb_friction=3.0)
    found = the_only(
        changed(WRONG, (*grown, Fault("torque_offset", joint="elbow_joint", offset=2.0)), seed=7)
    )
    assert found.term.label == "asymmetric_friction@elbow_joint"
    assert found.term.theta[:2] == pytest.approx((1.0, 5.0), abs=0.05)


def test_a_body_that_explains_next_to_nothing_beside_another_one_is_likely():
    left = {(): 100.0, (0,): 1.5, (1,): 60.0, (0, 1): 0.5}
    evidence = SimpleNamespace(
        effects=[SimpleNamespace(effect=Payload()), SimpleNamespace(effect=LinkInertia("elbow_joint"))],
        unexplained=lambda chosen: np.array([left[tuple(sorted(chosen))]]),
    )
    found = SimpleNamespace(
        chosen=(0, 1), search=SimpleNamespace(evidence=evidence, settings=ChangeSettings())
    )
    assert detection._corrections(found) == {1}
    left[0, 1] = 0.0
    left[(0,)] = 20.0  # then the link explains enough by itself
    assert detection._corrections(found) == set()


def test_a_change_with_a_rival_of_another_kind_is_likely_at_most(monkeypatch):
    assert the_only(changed(WRONG, GAIN)).confidence == "established"

    def every_offset(search, chosen, one):
        effects = search.evidence.effects
        return [c for c, e in enumerate(effects) if e.effect.label == "torque_offset@elbow_joint"]

    monkeypatch.setattr(ChangeSearch, "rivals", every_offset)
    change = the_only(changed(WRONG, GAIN))
    assert (change.term.label, change.confidence) == ("actuator_gain@elbow_joint", "likely")


def test_what_is_certain_under_another_name_is_there_when_others_are_sized(monkeypatch):
    """Before, friction had to hold without any payload, because it might be a body of the link before."""
    both = (*with_friction(coulomb_friction=3.0), Fault("payload", mass=1.5))

    def half_width(rival=None):
        def rivals(search, chosen, one):
            effects = search.evidence.effects
            its = [c for c, e in enumerate(effects) if e.label == rival and e.sign > 0]
            return its if effects[one].effect.name == "payload" else []

        monkeypatch.setattr(ChangeSearch, "rivals", rivals)
        changes = {c.term.label: c for c in changed(WRONG, both).changes}
        payload, friction = changes["payload"], changes["coulomb_friction@elbow_joint"]
        assert payload.confidence == ("likely" if rival else "established")
        assert friction.confidence == "established"
        return friction.term.half_widths[0]

    assert half_width("link_inertia@wrist_2_joint") < 1.5 * half_width()


def test_rivals_are_named_once_each_and_the_best_first(ur5):
    offset, spring, other = map(
        parse_effect,
        ("torque_offset@elbow_joint", "joint_spring@elbow_joint", "coulomb_friction@elbow_joint"),
    )
    term = Term(other, (1.0,))
    found = detection._confusions(term, [offset, spring, other, spring], ur5)
    assert [c.effects for c in found] == [(offset,), (spring,)]


def test_what_is_rare_may_be_small_in_what_logs_have_in_common(ur5):
    log = plant_of("ur5").run(WRONG, duration=8.0, seed=3).log
    model = Dynamics(ur5, (Term(parse_effect("joint_spring@elbow_joint"), (1.0, 0.1)),))
    experiment = Experiment.of(ur5, [condition(log, ur5, DiscoverySettings().searched)])
    prediction, kept = experiment.predict(model), []

    def wanted(effect):
        kept.append(effect.label)
        return True

    def scales(rare):
        kept.clear()
        groups = common_effects(experiment, prediction, DesignMatrix(experiment), wanted, rare)
        return {label: g.scale for label, g in zip(kept, groups, strict=True)}

    whole, less = scales(1.0), scales(0.01)
    shares = {label: float(np.max(less[label] / whole[label])) for label in whole}
    for own in ("viscous_friction", "torque_offset", "link_inertia", "joint_spring"):
        assert shares[f"{own}@elbow_joint"] == 1.0
    for rare in ("position_ripple@elbow_joint", "joint_spring@wrist_1_joint", "actuator_gain@elbow_joint"):
        assert shares[rare] == pytest.approx(0.01)


@pytest.mark.parametrize(("seconds", "confidence"), [(4.0, "likely"), (12.0, "established")])
def test_blocks_of_a_short_log_establish_nothing(seconds, confidence):
    plant, worn = plant_of("ur5"), Fault("coulomb_friction", joint="elbow_joint", level=4.0)
    logs = [
        plant.run(faults, duration=seconds, seed=seed).log
        for faults, seed in ((WRONG, 3), ((*WRONG, worn), 1003))
    ]
    change = the_only(what_changed(Dynamics(plant.robot), *logs))
    assert (change.term.label, change.confidence) == ("coulomb_friction@elbow_joint", confidence)


# Size of a change over its bound [1]: its own torque adds to what is left, and so to the uncertainty.
BEYOND = 1.2


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("wrong", [(), WRONG], ids=["clean", "wrong"])
def test_a_change_above_its_bound_is_named(wrong, sign):
    plant = plant_of("ur5")
    before, after = (plant.run(wrong, duration=SECONDS, seed=s).log for s in (3, 1003))
    model = Dynamics(plant.robot)
    unchanged = what_changed(model, before, after)
    assert not unchanged.changes
    assert set(unchanged.bounds) == set(plant.robot.joints)
    for joint in plant.robot.joints[1:4:2]:
        offset = np.zeros_like(after.effort)
        offset[:, plant.robot.joint_index(joint)] = sign * BEYOND * unchanged.bounds[joint].torque
        found = what_changed(model, before, dataclasses.replace(after, effort=after.effort + offset))
        named = {plant.robot.joints[j] for c in found.changes for j in c.term.effect.acts_on(plant.robot)}
        assert joint in named


def test_an_effect_that_the_later_log_never_shows_has_no_bound():
    plant = plant_of("ur5")
    before, after = (plant.run((), duration=SECONDS, seed=s).log for s in (3, 1003))
    nowhere = parse_effect("maximum(q - 50, 0)@elbow_joint")
    found = what_changed(Dynamics(plant.robot), before, after, settings=DiscoverySettings(extra=(nowhere,)))
    assert nowhere.label not in {b.term.label for b in found.bounds.values()}
