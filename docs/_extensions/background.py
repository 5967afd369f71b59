"""What runs beside the reading of the pages: the examples of the gallery, the commands of the tutorials."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
POOL = ThreadPoolExecutor(2)  # programs at once; their threads only wait
PATIENCE = 600.0  # [s], for one program on a machine that does much else


def run(given: list[str], folder: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run Python with this checkout's package and return what it printed.

    Args:
        given: What follows ``python``.
        folder: Where it runs.
        **environment: More variables of its environment.
    """
    return subprocess.run(
        [sys.executable, *given],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        timeout=PATIENCE,
        check=False,
    )
