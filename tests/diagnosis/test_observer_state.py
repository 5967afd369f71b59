"""The observer's state by name: each name is a view of its own place in the array of the kernels."""

import numpy as np
import pytest

from cdia_pin.diagnosis import kernel_rows
from cdia_pin.diagnosis.layout import layout
from cdia_pin.diagnosis.observer_state import ObserverState
from cdia_pin.effects import CoulombFriction, ViscousFriction

EFFECTS = (CoulombFriction("joint1"), ViscousFriction("joint1"))
NAMES = [
    name
    for name in vars(ObserverState)
    if not name.startswith("_") and name not in ("forget_past", "place_neurons")
]


@pytest.fixture
def state() -> ObserverState:
    return ObserverState(layout(3, EFFECTS, (4, 5, 2, 1)))


def test_every_name_has_a_place_of_its_own(state: ObserverState) -> None:
    for k, name in enumerate(NAMES):
        setattr(state, name, k + 1.0)
    for k, name in enumerate(NAMES):
        np.testing.assert_array_equal(getattr(state, name), k + 1.0)


def test_what_is_written_by_name_is_in_the_array_of_the_kernels(state: ObserverState) -> None:
    state.bound = [1.0, 2.0, 3.0]
    state.forget = 0.5
    assert state.array.sum() == 6.5
    assert state.parts["joint"][kernel_rows.BOUND].tolist() == [1.0, 2.0, 3.0]


def test_a_row_stays_a_view_when_it_is_written(state: ObserverState) -> None:
    residual = state.residual
    state.residual = 2.0
    assert residual.tolist() == [2.0] * 3


@pytest.mark.parametrize(
    ("first", "rows"),
    [
        ("RESIDUAL", "JOINT_ROWS"),
        ("PHI", "COLUMN_ROWS"),
        ("PHI_TICK", "PHI_ROWS"),
        ("ACTIVATION", "NEURON_ROWS"),
        ("OF_POSITION", "SIGNAL_ROWS"),
        ("TIME", "SCALARS"),
    ],
)
def test_rows_are_numbered_without_a_gap(first: str, rows: str) -> None:
    numbers = {k: v for k, v in vars(kernel_rows).items() if isinstance(v, int) and not k.startswith("_")}
    names = list(numbers)
    of_part = names[names.index(first) : names.index(rows)]
    assert [numbers[name] for name in of_part] == list(range(numbers[rows]))


def test_the_past_is_forgotten_and_beliefs_stay(state: ObserverState) -> None:
    state.array[:] = 1.0
    state.forget_past()
    assert not state.residual.any()
    assert not state.filtered.any()
    assert not state.gram.any()
    assert state.believed.all()
    assert state.bound.all()
    assert state.weights.all()
