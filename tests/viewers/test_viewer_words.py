"""Numbers and sentences that terminal and page share."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin.discovery.comparison import ResidualRegion
from cdia_pin.effects import CoulombFriction, Payload, from_expression
from cdia_pin.viewers import verdict_sentences
from cdia_pin.viewers.text_identification import sentences as identified
from cdia_pin.viewers.words import (
    course_words,
    effect_words,
    listed,
    number,
    percent,
    region_words,
    short_names,
    with_interval,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (12.345, "12.3"),
        (-0.5, "−0.500"),
        (1234.5, "1234"),
        (0.00012, "0.000120"),
        (1e-9, "1.00e−09"),
    ],
)
def test_numbers_have_three_digits(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.97, "97 %"),
        (0.046, "4.6 %"),
        (0.0092, "0.92 %"),
        (1e-6, "<0.01 %"),
        (0.0, "0.00 %"),
        (float("nan"), "–"),
    ],
)
def test_shares_are_percent(share, text):
    assert percent(share).replace("\xa0", " ") == text


@pytest.mark.parametrize(
    ("value", "interval", "unit", "text"),
    [
        (4.1234, (3.91, 4.33), "N·m", "4.12 ± 0.21 N·m"),
        (1234.5, (1000.0, 1469.0), "N·m", "1234 ± 234 N·m"),
        (0.5, (0.0, 0.9), "1", "0.50 [0.00, 0.90]"),
        (-3.2, None, "N", "−3.20 N"),
        (2.0, (2.0, 2.0), "kg", "2.00 kg"),
    ],
)
def test_an_interval_decides_the_digits(value, interval, unit, text):
    assert with_interval(value, interval, unit).replace("\xa0", " ") == text


def test_the_ends_of_a_region_are_told_apart():
    region = ResidualRegion("j", "velocity", -0.0004, 0.4, 1.0, 0.1, 2.0, "rad/s")
    assert region_words(region).replace("\xa0", " ") == "velocity in [0.00, 0.40] rad/s"


@pytest.mark.parametrize(
    ("names", "short"),
    [
        (["panda_joint1", "panda_joint2"], ["joint1", "joint2"]),
        (["shoulder_pan_joint", "elbow_joint"], ["shoulder_pan", "elbow"]),
        (["wam/base_yaw_joint", "wam/elbow_pitch_joint"], ["base_yaw", "elbow_pitch"]),
        (["joint1", "joint2"], ["joint1", "joint2"]),
        (["lwr_0_joint", "lwr_1_joint"], ["lwr_0", "lwr_1"]),
        (["iiwa/joint_a1", "iiwa/joint_a2"], ["a1", "a2"]),
        (["arm_joint_1", "arm_joint_12"], ["joint_1", "joint_12"]),
        (["a", "a_"], ["a", "a_"]),
        (["a_b", "a/b"], ["a_b", "a/b"]),
        (["_", "a"], ["_", "a"]),
        (["a_b", "a_b_c"], ["b", "b_c"]),
        (["only_joint"], ["only_joint"]),
    ],
)
def test_short_names_leave_out_what_all_share(names, short):
    assert list(short_names(names).values()) == short


def test_effects_in_words():
    assert effect_words(CoulombFriction(joint="elbow_joint")) == "coulomb friction on elbow_joint"
    assert effect_words(Payload()) == "payload"
    assert effect_words(from_expression("sin(3*q)*dq", "wrist")) == "sin(3*q)*dq on wrist"


def test_lists_in_words():
    assert [listed(x) for x in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]


def test_nothing_missing_says_so(results):
    found = replace(results.discovery, verdict="nothing-missing", trace=results.discovery.trace[:1])
    said = verdict_sentences(found)
    assert said[0].startswith("Nothing is missing")
    assert "noise floor" in said[1]


def test_explained_names_the_effect_and_the_doubt(doubtful):
    said = " ".join(verdict_sentences(doubtful))
    assert "down to the noise once stribeck friction on joint3 is added" in said
    assert (
        "hard to distinguish from coulomb friction on joint3; to distinguish them, move the joint slowly"
        in said
    )


def test_unexplained_names_the_joints(doubtful):
    found = replace(doubtful, verdict="unexplained", structure_left=("joint1",))
    assert "the residual on joint1 has structure" in verdict_sentences(found)[0]
    alone = replace(found, trace=found.trace[:1], structure_left=found.model.robot.joints)
    assert (
        verdict_sentences(alone)[0] == "The residual on all 4 joints has structure that no effect explains."
    )


@pytest.mark.parametrize(
    ("after", "said"),
    [
        (0.04, "falls from 12\u00a0% to 4.0\u00a0%"),
        (0.12, "stays at 12\u00a0%"),
        (0.15, "rises from 12\u00a0% to 15\u00a0%"),
    ],
)
def test_an_error_falls_stays_or_rises_as_it_does(results, after, said):
    assert course_words(0.12, after) == said
    found = results.discovery
    first, last = found.trace[0], found.trace[-1]
    worse = replace(last, rms=tuple(np.array(first.rms) * after / 0.12), heldout_rms=first.heldout_rms)
    sentences = verdict_sentences(replace(found, trace=(first, worse)))
    verb = said.split()[0]
    assert any(f"The error {verb} " in s and "was not fitted it stays at" in s for s in sentences), sentences


def test_an_identification_that_does_worse_on_new_data_says_so():
    found = SimpleNamespace(
        heldout_before=np.array([1.19]), heldout_after=np.array([1.24]), heldout_torque_rms=np.ones(1),
        base=SimpleNamespace(names=(), identifiable=()), margin=np.ones(1),
        model=SimpleNamespace(robot=SimpleNamespace(joints=("only",))),
    )  # fmt: skip
    assert identified(found)[0].startswith(
        "On data that was not fitted the error rises from 119\u00a0% to 124\u00a0%"
    )
