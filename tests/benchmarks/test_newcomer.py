"""The pages of the formats lead somebody new from `pip install` to a report."""

import pytest

from benchmarks.newcomer.__main__ import PAGES, answers
from benchmarks.newcomer.guide import Command, Install, TextFile, steps
from benchmarks.newcomer.samples import SAMPLES
from cdia_pin.logs.formats import FORMATS


def test_every_format_has_a_page_and_a_sample():
    assert set(SAMPLES) == set(FORMATS) == {p.stem for p in PAGES.glob("*.md")} - {"index"}


@pytest.mark.parametrize("name", SAMPLES)
def test_a_page_installs_before_it_checks_and_ends_in_a_report(name):
    first, *others = steps(PAGES / f"{name}.md")
    install = others.pop(0) if isinstance(first, TextFile) else first
    assert isinstance(install, Install) and "view" in install.extras
    commands = [step for step in others if isinstance(step, Command)]
    assert commands[0].words[0] == "check"
    assert any(step.report for step in commands)


def page(tmp_path, text):
    path = tmp_path / "page.md"
    path.write_text(text)
    return list(steps(path))


def test_steps_come_in_the_order_of_the_page(tmp_path):
    text = (
        "Write `gains.json`:\n\n```json\n{}\n```\n\n```sh not-run\nros2 bag record\n```\n\n"
        "```sh\npip install \"cdia-pin[ros]\"\ncdia check 'a b.csv' \\\n    --robot ur5  # a comment\n```\n\n"
        "```text\n$ cdia check x.csv\nan answer\n```\n\n```text\nno command\n```\n"
    )
    assert page(tmp_path, text) == [
        TextFile("gains.json", "{}\n"),
        Install("[ros]"),
        Command(("check", "a b.csv", "--robot", "ur5")),
        Command(("check", "x.csv"), "an answer\n"),
    ]


def test_what_nobody_can_type_is_refused(tmp_path):
    with pytest.raises(ValueError, match="cannot type 'rosrun cdia'"):
        page(tmp_path, "```sh\nrosrun cdia\n```\n")


def test_the_answer_is_what_stands_above_the_table_of_errors():
    printed = " explained down to the noise  error 70 %\n established       coulomb friction\n good for   x\n"
    assert list(answers(printed)) == [
        "explained down to the noise: error 70 %",
        "established: coulomb friction",
    ]
