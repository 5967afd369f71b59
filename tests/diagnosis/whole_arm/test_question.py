"""Joints that leave their thresholds one after another ask one thing; those that join late may ask another."""

from math import inf

from cdia_pin.diagnosis.whole_arm.question import ONE_AFTER_ANOTHER, Question


def test_joints_that_follow_each_other_ask_together() -> None:
    asked, is_late = Question.of({0}, 5.0).joined_by({0, 1}, 5.2)
    assert not is_late
    asked, is_late = asked.joined_by({0, 1, 2}, 5.0 + 0.9 * ONE_AFTER_ANOTHER)
    assert not is_late
    assert asked.joints == {0, 1, 2}
    assert asked.of_the_further() == asked


def test_what_joins_late_is_asked_since_it_joined_first() -> None:
    asked, is_late = Question.of({0}, 5.0).joined_by({0, 1}, 8.0)
    assert is_late
    asked, is_late = asked.joined_by({1, 2}, 11.0)
    assert is_late
    assert asked.of_the_further() == Question(8.0, frozenset({0, 1, 2}), 11.0, inf)


def test_a_joint_that_comes_back_does_not_join() -> None:
    asked = Question.of({0, 1}, 5.0)
    assert asked.joined_by({0}, 9.0) == (asked, False)
    assert asked.joined_by({0, 1}, 12.0) == (asked, False)
