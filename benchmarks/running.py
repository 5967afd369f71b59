"""Run the cases that have not been run, on several processes, and keep what came of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

from benchmarks.outcomes import Kept, Store, tell
from cdia_pin.cluster import run_each


class Named(Protocol):
    """What is to be run."""

    @property
    def id(self) -> str:
        """Its name."""


C = TypeVar("C", bound=Named)
O = TypeVar("O", bound=Kept)  # noqa: E741


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
    known = store.read()
    pending = [c for c in cases if c.id not in known] if jobs else []
    at = ""

    def where(sentence: str, share: float) -> None:
        nonlocal at
        at = sentence

    for done in run_each(run, pending, workers=jobs, progress=where) if pending else ():
        if done.error is not None:  # the others go on; the page tells that one is missing
            tell(f"{at}  FAILED  {done.item.id}: {done.why}")
            continue
        outcome = known[done.item.id] = done.result
        store.add(outcome)
        tell(f"{at}  {word(outcome)}")
    return [known[c.id] for c in cases if c.id in known]
