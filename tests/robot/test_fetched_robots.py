"""Robots that are fetched: at the first use only, kept afterwards, and clear where there is no network."""

import sys
import textwrap

import pytest

from cdia_pin.errors import RobotError
from cdia_pin.extras import MissingExtraError
from cdia_pin.robot import catalogue, load_robot
from cdia_pin.robot.catalogue import RobotSource

ORIGIN = catalogue()["ur5e"].origin
FETCHED = [name for name, entry in catalogue().items() if entry.source is RobotSource.FETCHED]


@pytest.fixture
def fetcher(tmp_path, monkeypatch):
    """A package robot_descriptions whose module does what is written in it, and an empty cache."""
    for module in [m for m in sys.modules if m.split(".")[0] == "robot_descriptions"]:
        monkeypatch.delitem(sys.modules, module)
    package = tmp_path / "site" / "robot_descriptions"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "_xacro.py").write_text(
        "def get_urdf_path(module, xacro_args=None): return module.URDF_PATH\n"
    )
    (package.parent / "xacrodoc.py").write_text("")
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    yield lambda code: (package / "ur5e_description.py").write_text(textwrap.dedent(code))
    for module in [m for m in sys.modules if m.split(".")[0] in {"robot_descriptions", "xacrodoc"}]:
        del sys.modules[module]


def test_a_fetched_robot_is_kept_and_needs_no_package_afterwards(fetcher, monkeypatch, capsys):
    urdf = catalogue()["ur5"].path
    fetcher(f"print('Cloning ...')\nURDF_PATH = {str(urdf)!r}")
    assert not catalogue()["ur5e"].available
    robot = load_robot("ur5e")
    assert (robot.name, robot.n, robot.tool_frame) == ("ur5e", 6, "tool0")
    said = capsys.readouterr()
    assert said.out == ""  # what git prints is no result of a command
    assert said.err.splitlines() == ["fetching the description of 'ur5e' from " + ORIGIN + ", once"]
    assert catalogue()["ur5e"].available
    monkeypatch.setitem(sys.modules, "robot_descriptions", None)
    assert load_robot("ur5e").joints == robot.joints


def test_without_a_network_the_error_says_what_the_first_use_needs(fetcher):
    fetcher("raise OSError('git: Could not resolve host')")
    with pytest.raises(
        RobotError, match=r"'ur5e' cannot be fetched.*needs git and the network.*URDF file"
    ) as caught:
        load_robot("ur5e")
    assert "Could not resolve host" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not catalogue()["ur5e"].available


def test_an_error_of_git_is_told_in_its_own_words_and_without_its_progress(fetcher, capsys):
    fetcher(
        """
        import sys

        class GitError(Exception):
            stderr = "fatal: unable to access the repository"

        print("Cloning ...")
        sys.stderr.write("0it [00:00, ?it/s]")
        raise GitError("Cmd('git') failed, cmdline: git fetch -v")
        """
    )
    with pytest.raises(RobotError, match=r"\(fatal: unable to access the repository\)$"):
        load_robot("ur5e")
    assert "0it" not in capsys.readouterr().err


def test_a_cache_that_was_deleted_or_broken_is_fetched_again(fetcher, tmp_path):
    fetcher(f"URDF_PATH = {str(catalogue()['ur5'].path)!r}")
    index = tmp_path / "cache" / "cdia-pin" / "robots.json"
    index.parent.mkdir(parents=True)
    for content in ("not JSON", "[]", '{"ur5e": "/nowhere/ur5e.urdf"}'):
        index.write_text(content)
        assert not catalogue()["ur5e"].available
        assert load_robot("ur5e").n == 6


def test_without_the_extra_the_line_that_installs_it_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setitem(sys.modules, "robot_descriptions", None)
    with pytest.raises(MissingExtraError, match=r"cdia-pin\[robots\]"):
        load_robot("ur5e")


@pytest.mark.parametrize("name", FETCHED)
def test_what_is_listed_of_a_robot_is_known_before_it_is_fetched(name):
    entry = catalogue()[name]
    assert entry.joints in {6, 7}
    assert entry.description and entry.licence
    assert entry.origin.startswith("https://")
