"""Generated code on disk, beside numba's own cache of it: the second start of a program does not compile again."""

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
    """Import the generated module from the cache folder, writing it there first."""
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
                draft.replace(
                    path
                )  # at once, so that two programs that start together do not meet half a file
        except OSError:
            continue
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module
    raise OSError("no folder to keep compiled code in")  # pragma: no cover  (a temporary one always works)


def _folders() -> Iterator[Path]:
    """Yield the user's cache folder, then a private one that lasts no longer than the machine's memory of it."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    yield Path(home) / "cdia-pin" / "kernels"
    yield Path(tempfile.mkdtemp(prefix="cdia-pin-"))


def _fingerprint(source: str, effects: Sequence[JointEffect]) -> str:
    """Return a hash that changes with all the text that is compiled, of which numba sees only a part."""
    from cdia_pin.diagnosis import codes, kernels

    digest = hashlib.sha256(f"{__version__}\n{source}".encode())
    linecache.checkcache()
    modules = {type(e).__module__ for e in effects} | {Unknown.__module__, codes.__name__, kernels.__name__}
    for name in sorted(modules):
        try:
            digest.update(inspect.getsource(sys.modules[name]).encode())
        except (OSError, TypeError, KeyError):
            digest.update(os.urandom(16))  # typed at a prompt: whether it is new nobody can tell
    return digest.hexdigest()[:16]
