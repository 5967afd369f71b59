"""Without an extra the core works, and what needs the extra says how to install it."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from cdia_pin.errors import CdiaError
from cdia_pin.extras import EXTRAS, MissingExtraError, missing_modules, require
from cdia_pin.resources import logs_dir

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
LOG = str(logs_dir() / "demo_ur5.csv")
DISTRIBUTIONS = {  # where names differ
    "collada": "pycollada",
    "fast_simplification": "fast-simplification",
    "robot_descriptions": "robot-descriptions",
}


def without(extra: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run ``cdia`` in a process in which the modules of an extra cannot be imported."""
    hidden = [module for name in {extra, *({"app"} if extra == "view" else ())} for module in EXTRAS[name]]
    code = (
        f"import sys; sys.modules.update(dict.fromkeys({hidden!r})); from cdia_pin.cli import main; "
        f"sys.exit(main({list(arguments)!r}))"
    )
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_modules_of_an_extra_are_those_that_pyproject_installs(extra):
    installed = {re.split(r"[<>=\[]", line)[0] for line in PROJECT["optional-dependencies"][extra]}
    assert {DISTRIBUTIONS.get(module, module) for module in EXTRAS[extra]} <= installed


def test_all_holds_every_extra():
    (everything,) = PROJECT["optional-dependencies"]["all"]
    named = set(re.findall(r"\w+", everything.partition("[")[2]))
    assert named | {"view"} == set(EXTRAS)  # app brings view
    assert "cdia-pin[view]" in PROJECT["optional-dependencies"]["app"]


def test_what_is_installed_is_not_missing():
    for extra in EXTRAS:
        assert missing_modules(extra) == []
        require(extra, "tests")


@pytest.mark.parametrize("extra", EXTRAS)
def test_a_missing_module_is_named_with_the_line_that_installs_it(monkeypatch, extra):
    module = EXTRAS[extra][-1]
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError) as caught:
        require(extra, "tests")
    assert str(caught.value) == f'tests need {module}, not installed here: pip install "cdia-pin[{extra}]"'
    assert isinstance(caught.value, CdiaError)
    assert isinstance(caught.value, ImportError)


@pytest.mark.parametrize(
    ("extra", "arguments"),
    [
        ("view", ("compare", LOG, "--robot", "ur5", "--report", "never.html")),
        ("view", ("discover", LOG, "--robot", "ur5", "--report", "never.html")),
        ("view", ("monitor", LOG, "--robot", "ur5", "--report", "never.html")),
        ("view", ("view", LOG, "--robot", "ur5", "--no-open")),
        ("view", ("demo", "--report", "never.html")),
        ("app", ("app", "--no-open")),
        ("figures", ("study", "thesis")),
        ("figures", ("study", "arms")),
        ("fleet", ("campaign", str(ROOT / "examples" / "friction.toml"), "--workers", "2")),
    ],
)
def test_a_command_says_so_before_it_works(extra, arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = without(extra, *arguments)
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr.startswith("cdia: error: ")
    assert run.stderr.endswith(f'pip install "cdia-pin[{extra}]"\n')
    assert run.stderr.count("\n") == 1
    assert not (tmp_path / "never.html").exists()


def test_a_bag_says_so_too(tmp_path):
    bag = tmp_path / "run.mcap"
    bag.write_bytes(b"\x89MCAP0\r\n")
    run = without("ros", "check", str(bag), "--robot", "ur5")
    assert run.returncode == 2
    assert run.stderr.endswith('pip install "cdia-pin[ros]"\n')


def test_numbers_need_no_extra():
    code = (
        f"import sys; sys.modules.update(dict.fromkeys({[m for e in EXTRAS.values() for m in e]!r})); "
        "from cdia_pin import Dynamics, Monitor, compare, load_robot, read_log, view; "
        "from cdia_pin import write_report; "
        "robot = load_robot('ur5'); "
        f"found = compare(Dynamics(robot), read_log({LOG!r}, robot)); "
        "print(found.rms.shape)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout.startswith("(6,)"), run.stderr
