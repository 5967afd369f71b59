"""Comparison: errors by joint equal a direct computation, and regions point at where the model is wrong."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, load_robot
from cdia_pin.discovery.comparison import REGIONS, _regions, _shape
from cdia_pin.effects import Term, parse_effect
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.regression.experiment import Experiment
from tests.made_logs import CUTOFF, make

NOISE = 0.004  # [N·m]


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def missing(q, v, a):
    return np.column_stack([-0.1 * v[:, 0] + 0.05, 0.03 * np.sin(3 * q[:, 1])])


@pytest.fixture(scope="module")
def made(pendulum):
    return make(pendulum, missing, noise=NOISE, seed=1)


@pytest.fixture(scope="module")
def compared(pendulum, made):
    return compare(Dynamics(pendulum), made.log, conditioning=CUTOFF)


def by_hand(robot, log):
    """Predicted and measured torque at the compared samples, by the plain filter on every sample."""
    m = condition(log, robot, CUTOFF)
    both = [
        zero_phase(x, m.cutoff, m.rate)[m.kept] for x in (robot.inverse_dynamics(m.q, m.v, m.a), m.effort)
    ]
    use = Experiment.of(robot, [m]).informative
    return *both, use, m


def test_errors_equal_a_direct_computation(pendulum, made, compared):
    predicted, measured, use, m = by_hand(pendulum, made.log)
    residual = np.where(use, predicted - measured, 0.0)
    count = use.sum(axis=0)
    np.testing.assert_allclose(compared.rms, np.sqrt((residual**2).sum(axis=0) / count), rtol=1e-3)
    np.testing.assert_allclose(compared.bias, residual.sum(axis=0) / count, atol=1e-4)
    torque = np.sqrt((np.where(use, measured, 0.0) ** 2).sum(axis=0) / count)
    np.testing.assert_allclose(compared.torque_rms, torque, rtol=1e-3)
    np.testing.assert_allclose(compared.relative_rms, compared.rms / compared.torque_rms)
    np.testing.assert_allclose(compared.time, m.time[m.kept])
    np.testing.assert_allclose(compared.residual, predicted - measured, atol=1e-3 * np.abs(measured).max())


def test_the_residual_is_predicted_less_measured(compared):
    np.testing.assert_allclose(compared.residual, compared.predicted - compared.measured)


def test_a_torque_offset_is_the_bias(pendulum):
    """The residual is the torque that the model lacks: f = c has the bias c."""
    log = make(pendulum, lambda q, v, a: np.tile([0.2, -0.1], (len(q), 1)), noise=NOISE, seed=2).log
    np.testing.assert_allclose(compare(Dynamics(pendulum), log).bias, [0.2, -0.1], atol=2e-3)


def test_a_model_with_the_missing_terms_is_left_with_noise(pendulum, made, compared):
    terms = [
        Term(parse_effect("viscous_friction@joint1"), (0.1,)),
        Term(parse_effect("torque_offset@joint1"), (0.05,)),
        Term(parse_effect("position_ripple@joint2").with_shape(frequency=3.0), (0.03, 0.0)),
    ]
    better = compare(Dynamics(pendulum, tuple(terms)), made.log, conditioning=CUTOFF)
    assert (better.rms < 0.1 * compared.rms).all()
    assert (better.rms < NOISE).all()
    assert (np.abs(better.bias) < 0.2 * better.rms).all()


def test_autocorrelation_tells_structure_from_noise(pendulum, made):
    rough = compare(Dynamics(pendulum), made.log, conditioning=CUTOFF).autocorrelation
    noise = make(pendulum, noise=NOISE, seed=3).log
    assert (rough > 0.9).all()
    assert (np.abs(compare(Dynamics(pendulum), noise, conditioning=CUTOFF).autocorrelation) < 0.7).all()


@pytest.mark.parametrize(("low", "high"), [(0.3, 0.45), (0.8, 1.0)])
def test_the_worst_region_is_where_a_friction_bump_is(low, high, pendulum):
    def bump(q, v, a):
        inside = (np.abs(v[:, 0]) > low) & (np.abs(v[:, 0]) < high) & (v[:, 0] > 0)
        return np.column_stack([-0.2 * inside, np.zeros(len(q))])

    made = make(pendulum, bump, noise=NOISE, seed=4)
    found = compare(Dynamics(pendulum), made.log, conditioning=CUTOFF)
    worst = found.worst_regions[0]
    assert worst.joint == "joint1"
    assert worst.signal == "velocity"
    assert worst.unit == "rad/s"
    assert worst.lower < high
    assert worst.upper > low
    assert worst.bias < 0
    assert worst.ratio > 1.5
    shares = {name: shape.share for name, shape in found.shapes["joint1"].items()}
    assert max(shares, key=shares.get) == "velocity"


@pytest.mark.parametrize("signal", ["position", "time", "acceleration"])
def test_the_signal_that_explains_the_residual_has_the_largest_share(signal, pendulum):
    def odd(q, v, a):
        x = {"position": q[:, 1], "time": np.linspace(-1, 1, len(q)), "acceleration": a[:, 1]}[signal]
        return np.column_stack([np.zeros(len(q)), 0.1 * np.cos(3 * x / np.abs(x).max())])

    log = make(pendulum, odd, noise=NOISE, seed=5).log
    shapes = compare(Dynamics(pendulum), log, conditioning=CUTOFF).shapes["joint2"]
    assert max(shapes, key=lambda s: shapes[s].share) == signal


def test_each_joint_has_its_regions_and_the_worst_come_first(pendulum, compared):
    for joint in pendulum.joints:
        assert 0 < len([r for r in compared.worst_regions if r.joint == joint]) <= REGIONS
    ratios = [r.ratio for r in compared.worst_regions]
    assert ratios == sorted(ratios, reverse=True)
    assert all(
        r.rms == pytest.approx(r.ratio * e) for r in compared.worst_regions for e in [_of(compared, r)]
    )


def _of(compared, region):
    return compared.rms[compared.model.robot.joint_index(region.joint)]


def test_a_signal_that_is_only_rounding_has_no_regions():
    shape = _shape(np.linspace(-1e-17, 1e-17, 200), np.sin(np.arange(200.0)))
    assert not _regions("joint1", "load", shape, 1.0, "N·m")
    assert shape.share == 0.0


def test_a_joint_that_slides_has_regions_in_metres_and_newtons():
    scara = load_robot("scara")
    found = compare(Dynamics(scara), make(scara, noise=0.1, seed=6).log)
    slides = scara.joints[int(np.flatnonzero(scara.is_prismatic)[0])]
    units = {r.signal: r.unit for r in found.worst_regions if r.joint == slides}
    known = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "load": "N", "time": "s"}
    assert units
    assert units.items() <= known.items()


def test_several_logs_are_compared_as_one(pendulum, made):
    other = make(pendulum, missing, noise=NOISE, seed=7)
    both = compare(Dynamics(pendulum), [made.log, other.log], conditioning=CUTOFF)
    each = [compare(Dynamics(pendulum), m.log, conditioning=CUTOFF) for m in (made, other)]
    counts = [c.informative.sum(axis=0) for c in each]
    mean = sum(n * c.rms**2 for n, c in zip(counts, each, strict=True)) / sum(counts)
    np.testing.assert_allclose(both.rms, np.sqrt(mean), rtol=1e-2)
    assert len(both.record["logs"]) == 2


def test_the_json_has_the_keys_of_its_schema(pendulum, compared):
    out = json.loads(json.dumps(compared.to_dict(), allow_nan=False))
    assert out["schema"] == "cdia-comparison/1"
    assert out["robot"] == pendulum.name
    assert out["joints"] == list(pendulum.joints)
    for key in ("rms", "relative_rms", "bias", "autocorrelation"):
        assert list(out[key]) == list(pendulum.joints)
        assert all(isinstance(x, float) for x in out[key].values())
    assert out["worst_regions"]
    for region in out["worst_regions"]:
        assert set(region) >= {"joint", "signal", "lower", "upper", "rms", "unit"}
        assert region["lower"] < region["upper"]


def test_the_record_says_how_the_log_was_conditioned(compared):
    (log,) = compared.record["logs"]
    assert log["cutoff"] == CUTOFF.cutoff
    assert {"source", "sha256", "log_rate", "compared_rate", "trim", "velocity"} <= set(log)
    assert compared.record["version"]


def test_the_same_log_gives_the_same_numbers(pendulum, made, compared):
    again = compare(Dynamics(pendulum), made.log, conditioning=CUTOFF)
    assert again.to_dict() == compared.to_dict()


def test_a_log_of_another_arm_is_refused(pendulum, made):
    with pytest.raises(LogError):
        compare(Dynamics(load_robot("scara")), made.log)


def test_speeds_in_the_log_are_not_believed(pendulum, made, compared):
    """A drive's speeds were filtered by the drive; motion is derived from the positions."""
    wrong = replace(made.log, velocity=np.zeros_like(made.q))
    assert compare(Dynamics(pendulum), wrong, conditioning=CUTOFF).rms == pytest.approx(compared.rms)
