"""The repr of every public object is one short line that names it."""

from dataclasses import replace

import pytest

import cdia_pin.logs as room
from cdia_pin.logs import Conversion, Severity, check_log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.readers.table import Table


@pytest.fixture(scope="module")
def examples(ur5, ur5_log) -> list[object]:
    long = replace(ur5_log, source="a long name, " * 30, notes=("a long note, " * 30,))
    check = check_log(long, ur5)
    table = Table({f"a long name of column {k}": ur5_log.time for k in range(50)})
    conversion = Conversion(angle="deg", flip_effort=ur5.joints, flip_position=ur5.joints, torque="A")
    return [ur5_log, long, check, *check.findings, conversion, condition(long, ur5), Conditioning(), table]


def test_a_repr_is_one_short_line_that_names_the_object(examples):
    for shown in examples:
        text = repr(shown)
        assert text.startswith(type(shown).__name__ + "("), text
        assert "\n" not in text
        assert len(text) < 200, text


def test_every_public_class_of_the_folder_has_an_example(examples):
    public = {x for x in vars(room).values() if isinstance(x, type)}
    assert {x for x in public if not issubclass(x, str)} <= {type(x) for x in examples}
    assert Severity in public


def test_the_repr_of_a_log_tells_its_size_and_rate(ur5_log):
    assert repr(ur5_log) == "Log('simulated', 6 joints, 5000 samples, 20 s at 250 Hz)"
