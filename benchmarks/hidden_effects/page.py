"""The page docs/results-discovery.md, from outcomes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.claim_tables import MUST_SHOW, by_part, targets
from benchmarks.hidden_effects.case import DURATION, SHORT
from benchmarks.hidden_effects.cases import EVERY_ARM, LARGE, SMALL
from benchmarks.hidden_effects.claims import PARTS, fell_short
from benchmarks.hidden_effects.contest import Score
from benchmarks.hidden_effects.further import contest_part, precision_part, promised
from benchmarks.hidden_effects.outcome import Outcome
from benchmarks.hidden_effects.precision import Estimate, precisions
from benchmarks.hidden_effects.trial import HELD_OUT
from benchmarks.markdown import details, table
from benchmarks.publishing import made_by

PACKAGES = ("pin", "mujoco", "numpy", "scipy")  # whose versions matter


def page(
    outcomes: Sequence[Outcome],
    estimates: Sequence[Estimate],
    scores: Sequence[Score],
    command: str,
    whole: bool,
) -> str:
    """Return the results as Markdown."""
    arms = sorted(dict.fromkeys(o.arm for o in outcomes), key=EVERY_ARM.index)
    precise = list(precisions(estimates))
    rows = [*targets(PARTS, outcomes), *promised(precise)]
    parts = [
        _head(outcomes, estimates, command, whole),
        "## Must show",
        table(MUST_SHOW, rows),
        *by_part(PARTS, outcomes, arms, lambda o: o.arm),
        *precision_part(precise),
        *contest_part(scores),
        "## Where it falls short",
        *_failures(outcomes),
    ]
    return "\n\n".join(parts) + "\n"


def _head(outcomes: Sequence[Outcome], estimates: Sequence[Estimate], command: str, whole: bool) -> str:
    sample = "" if whole else "**Some of the cases only, not the results.** "
    return (
        "# Results of the discovery\n\n"
        f"{sample}{made_by(command, PACKAGES)}\n\n"
        f"{len(outcomes)} cases and {len(estimates)} repeats of a few of them under other noise, on {len(EVERY_ARM)} "
        "arms in MuJoCo, which shares no code with the package. Joints, sizes, motions and noise are drawn from a seed "
        f"that the case's name gives. An effect's size is its RMS torque over that of its joint: {_shares(SMALL)} "
        f"(small) or {_shares(LARGE)} (large). Logs have 250 Hz and {DURATION:g} s, poor ones {SHORT:g} s. Noise: "
        "*white*, 1 % of each joint's torque; *coloured*, AR(1) of 20 ms, 2 %; *quantised*, encoders of 2·10⁻⁴ rad and "
        "torques in steps of 2 %. *Exact*: the effects and joints named are those hidden, no more and no fewer. "
        "*Noise floor*: "
        f"what the true model, with its true parameters, leaves of another motion of {HELD_OUT:g} s under the same "
        "conditioning; discovery has no part in it. *Can be told*: on this log, with the true noise, the best other "
        "effect with no more parameters misses the truth by ten standard deviations (a noncentrality λ of 10² at "
        "least). A body on the last link is the same whether it is called `payload` or `link_inertia`."
    )


def _shares(sizes: Sequence[float]) -> str:
    return " or ".join(f"{s:.0%}" for s in sizes)


def _failures(outcomes: Sequence[Outcome]) -> Iterator[str]:
    yield "Every case that is not what was hoped for, with what was said."
    for part in PARTS:
        rows = [
            (f"`{o.id}`", "; ".join(why), _labels(o.hidden), _labels(o.found), o.verdict)
            for o in outcomes
            if part.chosen(o) and (why := fell_short(o))
        ]
        if rows:
            total = sum(part.chosen(o) for o in outcomes)
            yield details(
                f"{part.title}: {len(rows)} of {total}",
                table(("case", "", "hidden", "found", "verdict"), rows),
            )


def _labels(labels: Sequence[str]) -> str:
    return ", ".join(f"`{_short(x)}`" for x in labels) or "–"


def _short(label: str) -> str:
    """Return a label; of one with many joints, how many there are."""
    name, _, joints = label.partition("@")
    count = joints.count("+") + 1
    return label if count <= 2 else f"{name}@{count} joints"
