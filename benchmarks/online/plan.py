"""Which cases the benchmark runs, by suite, and the outcomes that it has already."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable
from pathlib import Path

from benchmarks.online import scenarios as s
from benchmarks.online.outcome import Outcome
from benchmarks.online.scenarios import Case

CHECKOUT = Path(__file__).resolve().parents[2]
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
    digest = hashlib.sha256()
    files = [*(CHECKOUT / "cdia_pin").rglob("*.py"), *(CHECKOUT / "benchmarks" / "plant").rglob("*.py")]
    files += [f for f in (CHECKOUT / "benchmarks" / "online").glob("*.py") if f.name not in APART]
    apart = {CHECKOUT / "cdia_pin" / part for part in ("cli", "viewers", "campaigns", "discovery")}
    for file in sorted(files):
        if not apart & set(file.parents):
            digest.update(file.relative_to(CHECKOUT).as_posix().encode() + file.read_bytes())
    return digest.hexdigest()[:16]


class Store:
    """Outcomes of one arm as JSON lines, so that an interrupted run goes on where it was.

    Args:
        arm: Name of the arm.
        version: Of the text that outcomes depend on; those of other versions are not read.
        folder: Where the files are.
    """

    def __init__(self, arm: str, version: str, folder: Path = STORE) -> None:
        self.path = folder / f"{arm}-{version}.jsonl"

    def read(self) -> dict[str, Outcome]:
        """Return what is there, by the case's name; a line cut short by an interruption is left out."""
        if not self.path.exists():
            return {}
        lines = self.path.read_text(encoding="utf-8").splitlines()
        whole = [Outcome.from_json(line) for line in lines if line.endswith("}")]
        return {o.id: o for o in whole}

    def add(self, outcome: Outcome) -> None:
        """Append an outcome."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(outcome.to_json() + "\n")

    def forget(self) -> None:
        """Delete what is there."""
        self.path.unlink(missing_ok=True)
