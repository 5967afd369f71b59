"""A process of its own, and the processor time that it took: alike on an idle machine and on a busy one."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Sequence

ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL")}


def run(
    command: Sequence[str], timeout: float | None = None
) -> tuple[subprocess.CompletedProcess[str], float]:
    """Run a command in one thread.

    Args:
        command: The command.
        timeout: Most time that it may take [s].

    Returns:
        The process when it is done, and its processor time from start to end [s].
    """
    before = _spent()
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=timeout, env=os.environ | ONE_THREAD
    )
    return done, _spent() - before


def cdia(*arguments: str) -> tuple[subprocess.CompletedProcess[str], float]:
    """Run ``cdia`` as a user would; returns as `run` does."""
    return run([sys.executable, "-m", "cdia_pin", *arguments])


def _spent() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
