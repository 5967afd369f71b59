"""Which cases the benchmark runs, by suite, and the outcomes that it has already."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from benchmarks import outcomes
from benchmarks.online import scenarios as s
from benchmarks.online.outcome import Outcome
from benchmarks.online.scenarios import Case
from benchmarks.outcomes import CHECKOUT, package_text, text_hash

STORE = CHECKOUT / ".cache" / "online"
APART = {
    "__main__.py",
    "running.py",
    "plan.py",
    "claims.py",
    "page.py",
    "cost.py",
}  # files that no outcome depends on
SAMPLE = 6  # a quick run takes one case in so many, and as few minutes

Suite = Callable[[str], list[Case]]
SUITES: dict[str, Suite] = {
    "single": lambda arm: [c for share in s.SHARES for c in s.singles(arm, share)],
    "further": lambda arm: [c for share in s.SHARES for c in s.further(arm, share)],
    "pair": s.pairs,
    "triple": s.triples,
    "unknown": lambda arm: [c for share in (0.3, 0.5) for c in s.unknown(arm, share)],
    "return": s.returning,
    "joining": s.joining,
    "profile": s.fast_only,
    "arm": s.whole_arm,
    "hour": s.healthy_hour,
    "positions": lambda arm: s.under(arm, "positions"),
    "late": lambda arm: s.under(arm, "late"),
}


def planned(arm: str, suites: Iterable[str] = SUITES, quick: bool = False) -> list[Case]:
    """Return the cases of an arm, suite after suite; of each suite a sample if `quick`."""
    out = []
    for suite in suites:
        cases = SUITES[suite](arm)
        out += cases[:: min(SAMPLE, max(len(cases) // 2, 1))] if quick else cases
    return out


def fingerprint() -> str:
    """Return a hash of all text that an outcome depends on: the package, the plant, the cases."""
    here = [f for f in (CHECKOUT / "benchmarks" / "online").glob("*.py") if f.name not in APART]
    return text_hash([*package_text(("cli", "viewers", "campaigns", "cluster", "discovery")), *here])


class Store(outcomes.Store[Outcome]):
    """Outcomes of one arm.

    Args:
        arm: Name of the arm.
        version: Of the text that outcomes depend on; those of other versions are not read.
        folder: Where the files are.
    """

    def __init__(self, arm: str, version: str, folder: Path = STORE) -> None:
        super().__init__(folder / f"{arm}-{version}.jsonl", Outcome.from_json)
