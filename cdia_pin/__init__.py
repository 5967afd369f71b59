"""CDIA (Change Detection, Isolation, Accommodation) for robot arms, on Pinocchio.

Compare the model of a URDF arm with measured logs, find the physical effect that the model lacks, fit it and add it;
or monitor the arm while it moves:

    M(q) q̈ + nle(q, q̇) = τ + f,        f = Σ βᵢ(x) Φᵢ(x; sᵢ) θᵢ

A public name is loaded on first use, so that ``import cdia_pin`` stays fast.
"""

from __future__ import annotations

import ast as _ast
from importlib import import_module as _import_module
from pathlib import Path as _Path
from typing import Any as _Any

from cdia_pin.ipython import register_html as _register_html
from cdia_pin.ipython import register_with_running_ipython as _register_with_running_ipython


def _public_names() -> dict[str, str]:
    """Return the module of each public name, as the stub states it."""
    stub = _ast.parse(_Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = [node for node in stub.body if isinstance(node, _ast.ImportFrom)]
    return {alias.name: node.module or "" for node in imports for alias in node.names}


_HOME = _public_names()

__all__ = sorted(_HOME)  # noqa: PLE0605  (the stub holds the names)


def __getattr__(name: str) -> _Any:
    """Load a public name from its module on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'cdia_pin' has no attribute '{name}'")
    home = _HOME[name]
    value = _import_module(f"{home}.{name}") if home == __name__ else getattr(_import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


def load_ipython_extension(shell: _Any) -> None:
    """Show results as HTML in an IPython that was started after the import: ``%load_ext cdia_pin``.

    Args:
        shell: The shell.
    """
    _register_html(shell.display_formatter.formatters["text/html"])


_register_with_running_ipython()
