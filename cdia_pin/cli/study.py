"""``cdia study``: the thesis' numerical studies, repeated; each is one function and one line in the table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.next_command import show_next
from cdia_pin.cli.options import Json
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.errors import unknown_name
from cdia_pin.extras import require
from cdia_pin.version import __version__
from cdia_pin.whole_files import write_whole

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.campaigns.thesis_study import ThesisStudy

REPORT, ARMS_REPORT = "thesis_study.html", "arm_study.html"


@dataclass(frozen=True)
class StudyRequest:
    """The options of a study.

    Attributes:
        preset: ``literal``, ``physical`` or ``both``; None if not given.
        out: Directory for figures and report.
        json: File of the result.
        command: The command as typed.
    """

    preset: str | None
    out: Path | None
    json: str | None
    command: str


def study(
    ctx: typer.Context,
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            show_default=False,
            help="scara-model: the URDF against the closed form. thesis: its two numerical studies. "
            "arms: accommodation on panda, ur5 and xarm7 (some minutes).",
        ),
    ],
    preset: Annotated[
        str | None,
        typer.Option(
            "--preset",
            metavar="PRESET",
            show_default=False,
            help="Of the study thesis: literal (faults and gains as printed), physical, or both, the default.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            show_default=False,
            help="Directory for the figures (.png) and the report; ./out if left out.",
        ),
    ] = None,
    json: Json = None,
) -> None:
    """Repeat a numerical study of the thesis, with figures and the numbers that were measured."""
    if name not in STUDIES:
        raise CommandError(unknown_name("study", name, STUDIES))
    console = stdout(json)
    STUDIES[name](console, StudyRequest(preset, out, json, ctx.obj or f"cdia study {name}"))
    later = [*STUDIES][[*STUDIES].index(name) + 1 :]
    show_next(console, f"cdia study {later[0]}" if later else "cdia demo")


def _scara_model(console: Console, asked: StudyRequest) -> None:
    """M, V and G of the URDF against the closed form, as it should be and as it is printed."""
    from cdia_pin.campaigns.scara_model import scara_model_study
    from cdia_pin.viewers.whole_table import WholeTable

    if asked.preset or asked.out:
        raise CommandError("the study scara-model takes neither --preset nor --out")
    require_writable(asked.json)
    found = scara_model_study()
    table = WholeTable()
    table.add_column("term", style="bold")
    for heading in ("closed form", "as printed", ""):
        table.add_column(heading, justify="left" if not heading else "right")
    for a in found.agreements:
        table.add_row(a.term, f"{a.corrected:.1e}", f"{a.printed:.1e}", a.unit)
    console.print(f"Largest difference from the URDF through Pinocchio over {found.states} random states;")
    console.print("for the power balance, the power that has no source.")
    console.print(table)
    console.print(
        "The shipped closed form agrees with the URDF; the printed M and V belong to no rigid bodies."
        if found.agrees
        else "The shipped closed form does NOT agree with the URDF.",
    )
    write_all(console, (asked.json, lambda f: write_json({**found.to_dict(), "record": _record()}, f)))


def _thesis(console: Console, asked: StudyRequest) -> None:
    """Accommodation and isolation on the SCARA arm, with figures and a report."""
    from cdia_pin.campaigns.thesis_presets import PRESETS
    from cdia_pin.campaigns.thesis_study import thesis_study
    from cdia_pin.viewers.study_figures import thesis_pictures
    from cdia_pin.viewers.study_report import failures, isolation_sentence, write_study_report

    preset = asked.preset or "both"
    if preset not in {*PRESETS, "both"}:
        raise CommandError(unknown_name("preset", preset, [*PRESETS, "both"]))
    require("figures", "figures")
    out = _directory(asked)
    require_writable(asked.json, out / REPORT)
    with progress() as tell:
        found = thesis_study(tuple(PRESETS) if preset == "both" else (preset,), progress=tell)
        tell("drawing", 0.98)
        pictures = list(thesis_pictures(found))
    _show_thesis(console, found)
    for cases in found.cases.values():
        for sentence in failures(found.joints, cases):
            console.print(sentence, style="yellow", markup=False)
    console.print(isolation_sentence(found.isolations), markup=False)
    document = {**found.to_dict(), "record": _record()}
    write_all(
        console,
        *((out / f"{p.name}.png", lambda f, png=p.png: write_whole(f, png)) for p in pictures),
        (out / REPORT, lambda f: write_study_report(f, found, pictures, asked.command)),
        (asked.json, lambda f: write_json(document, f)),
    )


def _show_thesis(console: Console, found: ThesisStudy) -> None:
    from cdia_pin.campaigns.scara_run import UNITS
    from cdia_pin.viewers.whole_table import WholeTable

    for name, cases in found.cases.items():
        table = WholeTable(title=f"preset {name}, RMS of q − q_d")
        table.add_column("fault", style="bold")
        table.add_column("run", no_wrap=True)
        for joint, unit in zip(found.joints, UNITS, strict=True):
            table.add_column(f"{joint} [{unit}]".replace("[", "\\["), justify="right")
        for case in cases:
            for i, (kind, rms) in enumerate(case.tracking().items()):
                table.add_row("" if i else case.name, kind, *(f"{value:.2g}" for value in rms))
        console.print(table)


def _arms(console: Console, asked: StudyRequest) -> None:
    """Tracking of several arms healthy, with faults, and with a monitor."""
    from cdia_pin.campaigns.arm_study import ArmCase, arm_study, to_dict
    from cdia_pin.cli.unfinished_study import ShownCase, UnfinishedStudy
    from cdia_pin.viewers.arm_report import HEADINGS, write_arm_report
    from cdia_pin.viewers.whole_table import WholeTable

    if asked.preset:
        raise CommandError("the study arms takes no --preset")
    require("figures", "figures")
    out = _directory(asked)
    require_writable(asked.json, out / ARMS_REPORT)
    unfinished = UnfinishedStudy.beside(out / ARMS_REPORT, asked.command)
    with unfinished.resumed() as cases, progress() as tell:

        def keep(case: ArmCase) -> None:
            cases.append(ShownCase.of(case))
            unfinished.keep(cases)

        done = {(case.record["arm"], case.record["case"]) for case in cases}
        arm_study(done=done, keep=keep, progress=tell)
    table = WholeTable(title="RMS of q − q_d over all joints \\[mrad]")
    for k, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if 2 <= k < 6 else "left", no_wrap=2 <= k < 6)
    rows, pictures = [case.row for case in cases], [case.picture for case in cases]
    for row in rows:
        table.add_row(*row)
    console.print(table)
    settings = cases[0].settings
    document = {**to_dict([case.record for case in cases]), "record": {**_record(), "loop": vars(settings)}}
    write_all(
        console,
        *((out / f"{p.name}.png", lambda f, png=p.png: write_whole(f, png)) for p in pictures),
        (out / ARMS_REPORT, lambda f: write_arm_report(f, rows, settings, pictures, asked.command)),
        (asked.json, lambda f: write_json(document, f)),
    )
    unfinished.forget()


def _directory(asked: StudyRequest) -> Path:
    """Make the directory for figures and report."""
    out = asked.out or Path("out")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CommandError(f"cannot make the directory {out}: {error.strerror}") from None
    return out


def _record() -> dict[str, str]:
    return {"version": __version__}


STUDIES: dict[str, Callable[[Console, StudyRequest], None]] = {
    "scara-model": _scara_model,
    "thesis": _thesis,
    "arms": _arms,
}
