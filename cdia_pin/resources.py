"""Where files are: those that ship, in a checkout or in an installed wheel, and the user's cache."""

from __future__ import annotations

import os
from pathlib import Path

from cdia_pin.errors import CdiaError

_PACKAGE = Path(__file__).resolve().parent


def robots_dir() -> Path:
    """Folder of ``robots.toml`` and the robots that ship.

    Raises:
        CdiaError: If neither a checkout nor a complete installation is around this file.
    """
    return _shipped("robots", "robots")


def logs_dir() -> Path:
    """Folder of the logs that ship.

    Raises:
        CdiaError: If neither a checkout nor a complete installation is around this file.
    """
    return _shipped("logs", "examples/data")


def cache_dir() -> Path:
    """Folder of the user's cache; it may not exist."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(home) / "cdia-pin"


def _shipped(installed: str, checkout: str) -> Path:
    # The wheel carries these folders in cdia_pin/_data (see pyproject.toml); a checkout has them at its root.
    candidates = (_PACKAGE / "_data" / installed, _PACKAGE.parent / checkout)
    for folder in candidates:
        if folder.is_dir():
            return folder
    looked = " and ".join(str(c) for c in candidates)
    raise CdiaError(f"files that ship with cdia-pin are missing: looked for {looked}; reinstall the package")
