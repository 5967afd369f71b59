"""Optional parts of the installation: which packages they bring, and what is said where one is missing."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from types import MappingProxyType

from cdia_pin.errors import CdiaError

# Extra of pyproject.toml → the modules that it brings and that the package imports.
EXTRAS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "view": ("meshcat", "trimesh", "collada", "fast_simplification", "starlette", "uvicorn", "websockets"),
    "app": ("nicegui",),
    "ros": ("rosbags",),
    "figures": ("matplotlib",),
    "robots": ("robot_descriptions", "xacrodoc"),
    "fleet": ("distributed",),
})  # fmt: skip


NAMED = 2  # missing modules that a message names before it counts the others


class MissingExtraError(CdiaError, ImportError):
    """A part of the package needs an extra that is not installed."""


def missing_modules(extra: str) -> list[str]:
    """Return the modules of an extra that are not installed.

    Args:
        extra: A key of `EXTRAS`.
    """
    return [module for module in EXTRAS[extra] if find_spec(module) is None]


def require(extra: str, purpose: str) -> None:
    """Check that an extra is installed, before the work that needs it.

    Args:
        extra: A key of `EXTRAS`.
        purpose: What needs it, in the plural, to begin the message: ``"reports"``.

    Raises:
        MissingExtraError: If a module is missing; the message ends with the line that installs the extra.
    """
    if missing := missing_modules(extra):
        more = f" and {len(missing) - NAMED} more" if len(missing) > NAMED else ""
        named = f"{', '.join(missing[:NAMED])}{more}"
        raise MissingExtraError(
            f'{purpose} need {named}, not installed here: pip install "cdia-pin[{extra}]"'
        )
