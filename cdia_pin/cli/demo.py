"""``cdia demo``: the main job on the demo log."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.discovery_files import DiscoveryFiles
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs
from cdia_pin.cli.next_command import show_next
from cdia_pin.cli.options import Json, Report
from cdia_pin.extras import missing_modules

if TYPE_CHECKING:
    from rich.console import Console

FEW = 3  # effects of which the numbers are shown at once
ROBOT, LOG = "ur5", "demo_ur5.csv"


def demo(
    out: Annotated[
        Path,
        typer.Option("--out", metavar="DIR", help="Directory for the model and the report; made if needed."),
    ] = Path("out"),
    report: Report = None,
    json: Json = None,
) -> None:
    """Find two effects that are hidden in the demo log, add them, and see the error fall, in under a minute.

    Each step names the command that does the same for your own log.
    """
    from cdia_pin.resources import logs_dir

    log = logs_dir() / LOG
    if not log.is_file():
        raise CommandError(f"the demo's log is missing: {log}; reinstall the package")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CommandError(f"cannot make the directory {out}: {error.strerror}") from None
    if report is None and not missing_modules("view"):
        report = out / "demo_report.html"
    files = DiscoveryFiles(save=out / "demo_model.json", json=json, report=report)
    files.require_writable([log])
    _tell_the_story(stdout(json), log, files)


def _tell_the_story(console: Console, log: Path, files: DiscoveryFiles) -> None:
    from cdia_pin.discovery import compare, discover
    from cdia_pin.logs import check_log
    from cdia_pin.logs.conditioning import Conditioning
    from cdia_pin.viewers import check_table, comparison_table, discovery_table, where_it_fails

    name = _short(log)
    known = load_inputs(ROBOT, None)
    logs, _ = read_logs([log], known.robot, Reading(), check=False, tell=lambda *_: None)

    _step(console, 1, "Can the log be trusted?", f"cdia check {name} --robot {ROBOT}")
    checked = check_log(logs[0], known.robot)
    if checked.ok:
        console.print(f"   Nothing needs attention in {len(checked.findings)} findings on {log.name}.")
    else:
        console.print(check_table(checked))

    _step(console, 2, "Where does the URDF fail?", f"cdia compare {name} --robot {ROBOT}")
    before = compare(known, logs)
    console.print(comparison_table(before))
    console.print(where_it_fails(before))

    found_by = f"cdia discover {name} --robot {ROBOT} --save {files.save}"
    found_by += f" --report {files.report}" if files.report else ""
    _step(console, 3, "Which physical effects does it lack?", found_by)
    with progress() as tell:
        found = discover(known, logs, progress=tell)
    console.print(discovery_table(found, everything=len(found.steps) <= FEW))

    again = f"cdia compare {name} --robot {ROBOT} --model {files.save}"
    _step(console, 4, "With the effects added, what is left?", again)
    console.print(comparison_table(compare(found.model, logs)))

    console.print()
    files.write(console, found, known, logs, conditioning=Conditioning(), checks=[checked], command=found_by)
    strongest = found.steps[0].term.label if found.steps and found.steps[0].term else "EFFECT@JOINT"
    console.print(
        f"One effect at a time: cdia add {strongest} {name} --robot {ROBOT}", markup=False, soft_wrap=True
    )
    console.print(f"\n{_last_words(files.report)}", markup=False, soft_wrap=True)
    console.print("Your own log next: LOG is its file, R a name from cdia robots or a URDF file.")
    show_next(console, "cdia check LOG --robot R")


def _last_words(report: Path | None) -> str:
    """Say what to do with the report, or what to install for one."""
    if report is None:
        return 'A report with the arm in motion needs one more part: pip install "cdia-pin[view]"'
    return (
        f"Open {report} in a browser: the arm moves, links whose torque the URDF gets wrong are coloured, and the "
        "error falls as the effects are added."
    )


def _step(console: Console, number: int, question: str, command: str) -> None:
    from rich.text import Text

    console.print()
    console.print(Text(f"{number}. {question}", style="bold"))
    console.print(Text(f"   $ {command}", style="cyan"), soft_wrap=True)
    console.print()


def _short(path: Path) -> str:
    """Return a path as one would type it here."""
    here = Path.cwd()
    return shlex.quote(str(path.relative_to(here) if path.is_relative_to(here) else path))
