"""Weights after a calibration: the page says what came out, and how far off it is."""

import numpy as np

from benchmarks.known_weights import KNOWN, Weighing, page


def test_only_other_weights_by_calibrated_gains_count():
    found = [
        Weighing("nominal", "run", 1.3, 2.6, 0.1),
        Weighing("calibrated", "run", KNOWN, 5.2, 0.1),
        Weighing("calibrated", "run", 3.9, 3.9 * 1.02, 0.1),
        Weighing("calibrated", "run", 5.2, 5.2 * 0.95, 0.1),
    ]
    text = page(found).replace("\N{NO-BREAK SPACE}", " ")
    assert "| other weights: within 3 % | all | 50 % (1/2) | 2 | **NOT met** |" in text
    assert "5.0 %, of 5.2 kg" in text
    assert "| 2.6 kg (measured) |" in text
    assert "−5.0 %" in text and "+100 %" in text


def test_a_weight_that_is_not_named_is_as_wrong_as_can_be():
    assert Weighing("calibrated", "run", 3.9).error == np.inf
    assert "not named" in page([Weighing("calibrated", "run", 3.9)])
