"""The closed form that ships is the URDF's; the printed one is that of no rigid bodies."""

import numpy as np
import pytest

from cdia_pin.campaigns.scara_model import TOLERANCE, scara_model_study


@pytest.fixture(scope="module")
def found():
    return scara_model_study()


def test_ten_thousand_states_agree(found):
    assert found.states == 10_000
    assert found.agrees
    assert TOLERANCE == 1e-11
    assert [a.term for a in found.agreements] == ["M", "V", "G", "power balance"]


def test_the_printed_forms_differ_by_the_amounts_in_the_design_notes(found):
    M, V, G, power = found.agreements
    assert M.printed == pytest.approx(0.5 * 30.0 * 0.02**2)  # the quill's inertia, left out
    assert 5e3 < V.printed < 1e4
    assert G.printed == 0.0
    assert power.printed > 1e4


def test_the_power_balance_holds_for_the_form_that_ships(found):
    power = found.agreements[3]
    assert power.corrected < 1e-9 * power.printed


def test_a_seed_makes_it_repeatable():
    few = [scara_model_study(50, seed).to_dict()["terms"] for seed in (1, 1, 2)]
    assert few[0] == few[1] != few[2]


def test_a_wrong_model_is_detected(monkeypatch):
    from cdia_pin.robot import scara

    right = scara.velocity_torques
    monkeypatch.setattr(scara, "velocity_torques", lambda q, v: right(q, v) * (1 + 1e-9))
    assert not scara_model_study(100).agrees
    assert np.isfinite(scara_model_study(100).agreements[1].corrected)
