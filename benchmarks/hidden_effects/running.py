"""Run cases in several processes, and keep what came of each."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import Protocol, TypeVar

from benchmarks.outcomes import CHECKOUT, Kept, Store, package_text, tell, text_hash

STORE = CHECKOUT / ".cache" / "discovery"
APART = (
    "__main__.py",
    "running.py",
    "claims.py",
    "page.py",
    "further.py",
)  # files that no outcome depends on
WITHOUT = ("cli", "viewers", "campaigns", "diagnosis")  # parts of the package that none does


class Named(Protocol):
    """What is to be run."""

    @property
    def id(self) -> str:
        """Its name."""


C = TypeVar("C", bound=Named)
O = TypeVar("O", bound=Kept)  # noqa: E741


def store_of(kind: str, read_line: Callable[[str], O], folder: Path = STORE) -> Store[O]:
    """Return where outcomes of the present text are kept."""
    here = [f for f in Path(__file__).parent.glob("*.py") if f.name not in APART]
    return Store(folder / f"{kind}-{text_hash([*package_text(WITHOUT), *here])}.jsonl", read_line)


def run_all(
    cases: Sequence[C], run: Callable[[C], O], store: Store[O], jobs: int, word: Callable[[O], str]
) -> list[O]:
    """Run the cases that have not been run; return the outcomes of all that did not fail.

    Args:
        cases: What to run.
        run: Runs one; a function of a module, for other processes to find it.
        store: Where outcomes are kept.
        jobs: Number of processes; 0 to run nothing, and return what is kept.
        word: What to say of an outcome.
    """
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # small matrices; processes that start inherit it
    known = store.read()
    pending = [c for c in cases if c.id not in known] if jobs else []
    begin = perf_counter()
    with ProcessPoolExecutor(max(jobs, 1), mp_context=get_context("spawn")) as pool:
        try:
            running = {pool.submit(run, c): c for c in pending}
            for k, done in enumerate(as_completed(running), 1):
                left = (perf_counter() - begin) / k * (len(pending) - k) / 60
                at = f"{k:4}/{len(pending)} {left:4.0f} min left "
                if (
                    why := done.exception()
                ) is not None:  # the others go on; the page tells that one is missing
                    tell(f"{at} FAILED  {running[done].id}: {type(why).__name__}: {why}")
                    continue
                outcome = known[running[done].id] = done.result()
                store.add(outcome)
                tell(f"{at} {word(outcome)}")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [known[c.id] for c in cases if c.id in known]
