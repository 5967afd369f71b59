"""The counters of the house, each on a few lines whose count is plain."""

from textwrap import dedent

import pytest

from benchmarks.house import constants, docstrings, structure
from benchmarks.house.report import counts, page
from benchmarks.house.source import Module, modules


def module(text: str, name: str = "room/file.py") -> list[Module]:
    return [Module(name, dedent(text))]


def test_flags_are_truth_values_and_numbers_of_the_base_effect():
    text = """
        class Effect:
            name: ClassVar[str]
            shape: ClassVar[tuple] = ()
            linear: ClassVar[bool] = True
            rarity: ClassVar[float] = 0.0
            old = False
        class Payload(Effect):
            linear = False
    """
    assert structure.effect_flags(module(text, "effects/effect.py")) == 3
    assert structure.effect_flags(module(text, "logs/effect.py")) == 0


@pytest.mark.parametrize(
    ("call", "count"),
    [
        ("refit(experiment, columns, model, whitened)", 1),
        ("refit(self.experiment, problem.columns, model)", 1),
        ("refit(model, whitened=whitened, experiment=e.experiment)", 1),
        ("refit(problem, whitened)", 0),
        ("refit(regression)", 0),
    ],
)
def test_a_clump_is_two_of_its_arguments_in_one_call(call, count):
    assert structure.clump_calls(module(call)) == count


def test_a_name_is_taken_twice_across_files():
    one, two = module("class Step: pass\nclass Run: pass"), module("class Step: pass")
    assert structure.names_taken_twice([*one, *two]) == ["Step"]


def test_open_records_are_counted_where_they_are_annotations():
    text = "a: dict[str, Any]\nb: list[dict[str, Any]]\nc: dict[str, float]\n"
    assert structure.open_records(module(text)) == 2


def test_a_file_is_long_above_300_lines():
    files = [Module("a.py", "\n" * 300), Module("b.py", "\n" * 301)]
    assert structure.long_files(files) == ["b.py"]
    assert structure.lines(files) == 601


def test_a_constant_is_a_number_in_capitals():
    text = """
        WORTH = 0.1  # [1], share of what is left
        NEAR, FAR = 1.0, -2.0
        TIMES = (1, 2)
        NAME = "a"
        small = 3
    """
    assert [n.name for n in constants.constants(module(text))] == ["WORTH", "NEAR", "FAR", "TIMES"]


@pytest.mark.parametrize(
    ("line", "comment", "source"),
    [
        ("LIMIT = 3", False, False),
        ("LIMIT = 3  # [s]", False, False),
        ("LIMIT = 3  # [s], after which a run is given up", True, False),
        ("LIMIT = 3  # [s], measured on 20 logs", True, True),
        ("# From [Lee2020].\nLIMIT = 3", True, True),
    ],
)
def test_a_reason_is_more_than_a_unit_and_a_source_says_where_from(line, comment, source):
    (number,) = constants.constants(module(line))
    assert (number.has_comment, number.has_source) == (comment, source)


def test_a_setting_is_explained_by_the_docstring_of_its_class():
    text = '''
        class RunSettings:
            """How it runs.

            Attributes:
                rate: Samples a second [Hz], because
                    the filter needs as many.
            """

            rate: float = 100.0
            other: int = 3
            name: str = "a"
    '''
    rate, other = constants.settings(module(text))
    assert rate.has_source
    assert not other.has_comment


def test_only_public_functions_with_arguments_need_a_section():
    text = '''
        def one(a):
            """Do.

            Args:
                a: Angle [rad].
            """
        def two(*, b): ...
        def none(): ...
        def _private(a): ...
        class Thing:
            def method(self): ...
            def other(self, x): ...
    '''
    assert docstrings.with_args(module(text)) == docstrings.Share(1, 3)


def test_the_reference_is_what_the_rooms_export():
    text = "def one(a): ...\nclass Thing:\n    def other(self, x): ...\ndef inner(a): ...\n"
    exported = Module("room/__init__.py", "__all__ = ['one', 'Thing']")
    assert docstrings.with_args_in_reference([exported, *module(text)]) == docstrings.Share(0, 2)


def test_the_page_has_a_column_for_each_checkout(tmp_path):
    (tmp_path / "cdia_pin").mkdir()
    (tmp_path / "cdia_pin" / "a.py").write_text("A = 1\n")
    found = counts(tmp_path, {"tests": "7 min"})
    assert "| files | 1 | 1 |" in page({"before": found, "after": found}, "make house")
    assert found["`make test`, two idle cores"] == "7 min"


def test_a_folder_without_the_package_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="give the root of a checkout"):
        modules(tmp_path)
