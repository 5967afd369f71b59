"""Descriptions of robots that do not ship: robot_descriptions fetches them once, and the user's cache keeps them.

robot_descriptions clones the repository of a robot's authors, and expands its xacro files. Where the result stands is
written down, so that later uses need neither the network nor that package.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from cdia_pin.errors import RobotError
from cdia_pin.extras import require
from cdia_pin.input_files import read_text, resolved
from cdia_pin.phrases import one_line
from cdia_pin.resources import cache_dir
from cdia_pin.whole_files import whole_file

LONGEST_ANSWER = 200  # characters of what git or xacro says that are shown
INDEX = "robots.json"  # {name: URDF file}
# git asks nobody for a password, and gives up a transfer below 1 kB/s for 20 s.
GIT = {"GIT_TERMINAL_PROMPT": "0", "GIT_HTTP_LOW_SPEED_LIMIT": "1000", "GIT_HTTP_LOW_SPEED_TIME": "20"}


def known_urdf(name: str) -> Path | None:
    """Return the description of a robot that was fetched before.

    Args:
        name: Name in the catalogue.

    Returns:
        The URDF file; None if it was not fetched, or is no longer there.
    """
    path = _index().get(name)
    return Path(path) if path is not None and Path(path).is_file() else None


def fetched_urdf(name: str, module: str, arguments: Mapping[str, str], origin: str) -> Path:
    """Return the description of a robot, which is fetched at its first use.

    Args:
        name: Name in the catalogue.
        module: Module of robot_descriptions.
        arguments: Arguments of its xacro file.
        origin: Where it comes from, for messages.

    Returns:
        The URDF file.

    Raises:
        MissingExtraError: If the extra ``robots`` is not installed.
        RobotError: If it cannot be fetched.
    """
    if (known := known_urdf(name)) is not None:
        return known
    require("robots", f"robots that are fetched, such as {name},")
    try:
        print(f"fetching the description of '{name}' from {origin}, once", file=sys.stderr, flush=True)
        # What git and xacro print is no result of a command, and their progress bars would run into an error.
        with _printing_nothing(), _environment(GIT):
            description = importlib.import_module(f"robot_descriptions.{module}")
            get_urdf_path = importlib.import_module("robot_descriptions._xacro").get_urdf_path
            options = {"xacro_args": dict(arguments)} if arguments else {}
            path = Path(get_urdf_path(description, **options))
    except Exception as error:  # git, xacro and the network each raise their own
        words = getattr(error, "stderr", None)  # git's own, without the call
        said = one_line(Exception(words) if words else error, LONGEST_ANSWER)
        raise RobotError(
            f"the description of '{name}' cannot be fetched from {origin}: its first use needs git and the network; "
            f"without them give the path of a URDF file ({said})"
        ) from None
    _remember(name, path)
    return path


@contextlib.contextmanager
def _printing_nothing() -> Iterator[None]:
    """Leave out what other packages print."""
    unread = io.StringIO()  # left open: a progress bar may still write when it is deleted
    with contextlib.redirect_stdout(unread), contextlib.redirect_stderr(unread):
        yield


@contextlib.contextmanager
def _environment(settings: Mapping[str, str]) -> Iterator[None]:
    """Set variables of the environment that the user has not set."""
    mine = {name: value for name, value in settings.items() if name not in os.environ}
    os.environ.update(mine)
    try:
        yield
    finally:
        for name in mine:
            os.environ.pop(name, None)


def _index() -> dict[str, str]:
    try:
        known = json.loads(read_text(cache_dir() / INDEX))
    except (OSError, ValueError):
        return {}
    return {str(k): str(v) for k, v in known.items()} if isinstance(known, dict) else {}


def _remember(name: str, path: Path) -> None:
    """Write down where a description stands; without a cache it is looked up again."""
    with contextlib.suppress(OSError):
        cache_dir().mkdir(parents=True, exist_ok=True)
        with whole_file(cache_dir() / INDEX) as file:
            file.write(json.dumps({**_index(), name: str(resolved(path))}, indent=1).encode())
