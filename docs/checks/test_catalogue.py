"""The catalogue tells of every effect of the vocabulary, once."""

import re
from pathlib import Path
from runpy import run_path

import pytest

from cdia_pin import load_robot
from cdia_pin.effects import EFFECTS, parse_term

PAGES = sorted((Path(__file__).resolve().parents[1] / "effects").glob("*.md"))
ENTRY = re.compile(r"^```\{effect\} (.+)\n((?:(?!```).*\n)*)```$", re.MULTILINE)
README = (PAGES[0].parents[2] / "README.md").read_text(encoding="utf-8")
SIZES = run_path(str(PAGES[0].parents[1] / "_extensions" / "measured_sizes.py"))
WORDS = {"eight": 8, "nine": 9, "ten": 10, "eleven": 11, "twelve": 12}
ENTRIES = [found for page in PAGES for found in ENTRY.findall(page.read_text(encoding="utf-8"))]


def test_every_effect_has_one_entry():
    robot = load_robot("ur5")
    assert sorted(parse_term(text, robot).effect.name for text, _ in ENTRIES) == sorted(EFFECTS)


@pytest.mark.parametrize("text, physics", ENTRIES, ids=[text.partition(":")[0] for text, _ in ENTRIES])
def test_an_entry_says_what_happens(text, physics):
    assert physics.strip().endswith(".")


@pytest.mark.parametrize("text, physics", ENTRIES, ids=[text.partition(":")[0] for text, _ in ENTRIES])
def test_an_entry_has_a_size_that_was_measured_or_says_what_sets_it(text, physics):
    assert physics.startswith(":size: ") or SIZES["sentence"](parse_term(text).effect.name)


def test_the_readme_counts_the_effects_that_a_search_tries():
    searched = [kind.name for kind in EFFECTS.values() if kind.plausibility.searched]
    (effects, frictions) = re.search(r"a search knows (\d+) \((\w+) kinds of friction", README).groups()
    assert int(effects) == len(searched)
    assert WORDS[frictions] == sum(name.endswith("_friction") for name in searched)
