"""The cache of generated code on disk, beside numba's own: a program compiles at its first start only.

A file of either cache may be broken, for example because a disk was full. Then it is deleted, and the code is compiled
again.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import linecache
import logging
import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Timer
from types import ModuleType
from typing import Any

from cdia_pin.effects import JointEffect, Unknown
from cdia_pin.resources import cache_dir
from cdia_pin.version import __version__

SILENT = 1.5  # [s] of waiting for a compilation before it is said: from the cache it takes less


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
            if not _holds(path, source):
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


def first_call(what: str, modules: Iterable[ModuleType], call: Callable[[], object]) -> None:
    """Call compiled code for the first time, before a control loop does; what is broken in the cache is deleted.

    A compilation that takes more than a moment is announced by a warning of the logger ``cdia_pin``.

    Args:
        what: What is compiled, for that warning.
        modules: The modules whose compiled functions are called; each may call what stands behind it.
        call: Calls them; called once more if the cache was broken.
    """
    modules = tuple(modules)
    _forget_stale(modules)
    text = f"compiling {what}: this takes some seconds, at the first use only"
    waiting = Timer(SILENT, logging.getLogger("cdia_pin").warning, (text,))
    waiting.daemon = True
    waiting.start()
    try:
        try:
            call()
        except Exception:  # a broken file raises whatever its bytes happen to mean
            if not forget(modules):
                raise
            call()
    finally:
        waiting.cancel()


def forget(modules: Iterable[ModuleType]) -> int:
    """Delete numba's cache of modules, and return how many files it had.

    Args:
        modules: Modules with compiled functions.
    """
    count = 0
    for module in modules:
        for path in _kept(module):
            with suppress(OSError):
                path.unlink()
                count += 1
    return count


def _forget_stale(modules: Sequence[ModuleType]) -> None:
    """Delete what was compiled before a module behind it was changed: numba watches a function's own file alone."""
    changed = 0.0
    for module in reversed(modules):
        if any(path.stat().st_mtime < changed for path in _kept(module)):
            forget((module,))
        changed = max(changed, Path(module.__file__ or "").stat().st_mtime)


def _kept(module: ModuleType) -> list[Path]:
    """Return the files of numba's cache of a module."""
    stem = Path(module.__file__ or module.__name__).stem
    folders = {Path(f.stats.cache_path) for f in _compiled(module) if f.stats.cache_path}
    return [path for folder in folders for path in folder.glob(f"{stem}.*.nb[ic]")]


def _compiled(module: ModuleType) -> list[Any]:
    """Return the compiled functions of a module."""
    return [f for f in vars(module).values() if hasattr(f, "py_func") and f.__module__ == module.__name__]


def _holds(path: Path, source: str) -> bool:
    """Tell whether a file holds a text."""
    try:
        return path.read_text(encoding="utf-8") == source
    except (FileNotFoundError, UnicodeDecodeError):
        return False


def _folders() -> Iterator[Path]:
    """Yield the user's cache folder, then a private temporary one."""
    yield cache_dir() / "kernels"
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
