"""The cache of generated code on disk, beside numba's own: a program compiles at its first start only."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import linecache
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import ModuleType

from cdia_pin.effects import JointEffect, Unknown
from cdia_pin.version import __version__


def load(source: str, effects: Sequence[JointEffect]) -> ModuleType:
    """Import the generated module from the cache folder; write it there first if need be.

    Args:
        source: Text of the module.
        effects: Effects whose source the module compiles.
    """
    name = f"tick_{_fingerprint(source, effects)}"
    if name in sys.modules:
        return sys.modules[name]
    for folder in _folders():
        path = folder / f"{name}.py"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if not path.exists():
                draft = path.with_suffix(f".{os.getpid()}")
                draft.write_text(source, encoding="utf-8")
                draft.replace(path)  # in one step: a program that starts meanwhile never reads half a file
        except OSError:
            continue
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module
    raise OSError("no folder to keep compiled code in")  # pragma: no cover  (a temporary folder always works)


def _folders() -> Iterator[Path]:
    """Yield the user's cache folder, then a private temporary one."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    yield Path(home) / "cdia-pin" / "kernels"
    yield Path(tempfile.mkdtemp(prefix="cdia-pin-"))


def _fingerprint(source: str, effects: Sequence[JointEffect]) -> str:
    """Return a hash of all the text that is compiled; numba itself watches only a part of it."""
    from cdia_pin.diagnosis import kernel_rows, kernels, tick_flags

    digest = hashlib.sha256(f"{__version__}\n{source}".encode())
    linecache.checkcache()
    own = {Unknown.__module__, kernel_rows.__name__, kernels.__name__, tick_flags.__name__}
    modules = {type(e).__module__ for e in effects} | own
    for name in sorted(modules):
        try:
            digest.update(inspect.getsource(sys.modules[name]).encode())
        except (OSError, TypeError, KeyError):
            digest.update(os.urandom(16))  # typed at a prompt: its source is not known, so it counts as new
    return digest.hexdigest()[:16]
