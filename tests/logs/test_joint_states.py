"""Serialised JointState messages are read as rosbags reads them, one by one or all at once."""

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from cdia_pin.logs.readers.joint_states import MOST_LAYOUTS, joint_states

STORE = get_typestore(Stores.ROS2_HUMBLE)
JOINT_STATE = "sensor_msgs/msg/JointState"


def message(rng: np.random.Generator, names: list[str], sizes: tuple[int, int, int], frame: str = "base"):
    types = STORE.types
    stamp = types["builtin_interfaces/msg/Time"](int(rng.integers(2**31)), int(rng.integers(10**9)))
    signals = (rng.normal(size=size) for size in sizes)
    return types[JOINT_STATE](types["std_msgs/msg/Header"](stamp, frame), names, *signals)


def agree(given, little_endian: bool = True) -> None:
    raw = [bytes(STORE.serialize_cdr(m, JOINT_STATE, little_endian=little_endian)) for m in given]
    found = joint_states(raw)
    assert sorted(k for states in found for k in states.index) == list(range(len(raw)))
    for states in found:
        for row, k in enumerate(states.index):
            said = STORE.deserialize_cdr(raw[k], JOINT_STATE)
            assert states.names == tuple(said.name)
            assert states.stamp[row] == said.header.stamp.sec * 10**9 + said.header.stamp.nanosec
            for signal in ("position", "velocity", "effort"):
                np.testing.assert_array_equal(getattr(states, signal)[row], getattr(said, signal))


@pytest.mark.parametrize("little_endian", [True, False])
def test_numbers_are_those_of_another_reader_for_any_frame_names_and_empty_arrays(little_endian):
    rng = np.random.default_rng(0)
    given = [
        message(
            rng,
            [f"joint_{'x' * (k % 9)}{i}" for i in range(k % 4)],
            (k % 4, 0, k % 2 * (k % 4)),
            "f" * (k % 7),
        )
        for k in range(60)
    ]
    agree(given, little_endian)


def test_more_orders_of_joints_than_layouts_that_are_tried():
    rng = np.random.default_rng(1)
    given = [message(rng, list(rng.permutation(list("abcdefg"))), (7, 7, 7)) for _ in range(3 * MOST_LAYOUTS)]
    agree(given)


def test_messages_of_one_layout_come_back_as_one_block():
    rng = np.random.default_rng(2)
    raw = [bytes(STORE.serialize_cdr(message(rng, ["a", "b"], (2, 2, 2)), JOINT_STATE)) for _ in range(50)]
    (states,) = joint_states(raw)
    assert states.position.shape == (50, 2)


@pytest.mark.parametrize("end", [3, 11, 20, 60, -1])
def test_a_message_that_is_cut_off_is_refused(end):
    raw = bytes(STORE.serialize_cdr(message(np.random.default_rng(3), ["a", "b"], (2, 2, 2)), JOINT_STATE))
    with pytest.raises(ValueError, match="JointState"):
        joint_states([raw[:end]])
