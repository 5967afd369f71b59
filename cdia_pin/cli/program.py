"""The program: its commands, and the exit code and message of an error."""

from __future__ import annotations

import inspect
import os
import shlex
import sys
import warnings
from collections.abc import Sequence
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from cdia_pin.cli.add import add
from cdia_pin.cli.app import app as app_command
from cdia_pin.cli.calibrate import calibrate
from cdia_pin.cli.campaign import campaign
from cdia_pin.cli.check import check
from cdia_pin.cli.compare import compare
from cdia_pin.cli.console import close_stdout
from cdia_pin.cli.convert import convert
from cdia_pin.cli.demo import demo
from cdia_pin.cli.discover import discover
from cdia_pin.cli.effects import effects
from cdia_pin.cli.excite import excite
from cdia_pin.cli.export import export
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.fleet import fleet
from cdia_pin.cli.identify import identify
from cdia_pin.cli.interrupts import insistent
from cdia_pin.cli.monitor import monitor
from cdia_pin.cli.options import examples
from cdia_pin.cli.robots import robots
from cdia_pin.cli.simulate import simulate
from cdia_pin.cli.streams import mend_streams
from cdia_pin.cli.study import study
from cdia_pin.cli.trend import trend
from cdia_pin.cli.tune import tune
from cdia_pin.cli.view import view
from cdia_pin.errors import CdiaError, unknown_name
from cdia_pin.fault_report import fault_sentence, is_fault
from cdia_pin.phrases import clipped, one_line, printable
from cdia_pin.version import __version__

BAD_INPUT, FAULT, INTERRUPTED = 2, 70, 130  # exit codes; 70 is EX_SOFTWARE of sysexits.h
LONGEST_MESSAGE = 2000  # characters; names in files may be of any length
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

UsageError: type[Exception] = typer.BadParameter.__bases__[0]  # typer does not name it itself


class Commands(TyperGroup):
    """The commands; an unknown name is answered with the nearest ones."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that the first argument names."""
        if args and not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            raise CommandError(unknown_name("command", args[0], self.list_commands(ctx)))
        return super().resolve_command(ctx, args)

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names in the order in which they were added."""
        return list(self.commands)


app = typer.Typer(
    cls=Commands,
    add_completion=False,
    rich_markup_mode="rich",
    epilog=examples(
        "cdia demo", "cdia compare run.csv --robot ur5", "cdia discover run.csv --robot ur5 --save model.json"
    ),
)


@app.callback(invoke_without_command=True)
def cdia(
    ctx: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version and leave.")] = False,
) -> None:
    """CDIA: Change Detection, Isolation and Accommodation for robot arms.

    Find which physical effect the model of an arm lacks, add it, and see the error fall; or monitor the arm while it
    moves.
    """
    if version:
        typer.echo(f"cdia-pin {__version__}")
    elif ctx.invoked_subcommand is None:
        typer.echo(ctx.get_help())


def unwrapped(text: str) -> str:
    """Return a docstring with one line per paragraph, for a terminal to wrap at its own width.

    Args:
        text: The docstring.
    """
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in inspect.cleandoc(text).split("\n\n"))


JOB, MODELS, MANY, KNOWN = "The job", "Models and logs", "Many robots and runs", "What there is"
for command, panel, example in (
    (demo, JOB, ["cdia demo"]),
    (check, JOB, ["cdia check run.csv --robot ur5"]),
    (
        compare,
        JOB,
        [
            "cdia compare run.csv --robot ur5 --model model.json --report before.html",
            "cdia compare monday.csv friday.csv --robot ur5",
            "cdia compare free.csv pressing.csv --robot ur5 --contact",
        ],
    ),
    (
        discover,
        JOB,
        [
            "cdia discover run.csv --robot ur5 --save model.json --report found.html",
            "cdia discover pool.csv --robot my_arm.urdf --environment water --mounted tilted",
        ],
    ),
    (add, JOB, ["cdia add coulomb_friction@elbow_joint run.csv --robot ur5 --save model.json"]),
    (
        excite,
        JOB,
        [
            "cdia excite --robot ur5 --out motion.csv",
            "cdia excite --robot ur5 --between coulomb_friction@elbow_joint load_friction@elbow_joint --out motion.csv",
        ],
    ),
    (
        monitor,
        JOB,
        [
            "cdia monitor run.csv --robot ur5 --healthy before.csv --report watch.html",
            "cdia monitor run.csv --robot ur5 --model model.json --bank coulomb_friction --bank actuator_gain",
        ],
    ),
    (app_command, JOB, ["cdia app", "cdia app run.csv --robot ur5 --gains gains.json"]),
    (
        view,
        JOB,
        [
            "cdia view run.csv --robot ur5 --healthy before.csv",
            "cdia view --simulate --robot ur5 --fault 'coulomb_friction@elbow_joint: level=5, after=4'",
        ],
    ),
    (
        identify,
        JOB,
        ["cdia identify run.csv --robot ur5 --holdout other.csv --save model.json --urdf corrected.urdf"],
    ),
    (
        calibrate,
        JOB,
        [
            "cdia calibrate loaded.csv unloaded.csv --known-payload 2.6 --robot ur5 --gains nominal.json "
            "--save gains.json"
        ],
    ),
    (
        export,
        MODELS,
        [
            "cdia export --robot ur5 --model model.json --urdf corrected.urdf --mjcf corrected.xml",
            "cdia export --robot ur5 --model model.json --ur-payload payload.script --ranges ranges.json",
        ],
    ),
    (
        simulate,
        MODELS,
        ["cdia simulate --robot ur5 --fault 'coulomb_friction@elbow_joint: level=5, after=4' --out run.csv"],
    ),
    (
        fleet,
        MANY,
        [
            "cdia fleet add --robots fleet.toml --store fleet",
            "cdia fleet add cell-3/2026-05-12.csv --robots fleet.toml --store fleet",
            "cdia fleet show fleet",
        ],
    ),
    (
        trend,
        MANY,
        [
            "cdia trend fleet --report trend.html",
            "cdia trend fleet --false-alarms 0.02 --prometheus cdia.prom",
        ],
    ),
    (
        campaign,
        MANY,
        [
            "cdia campaign friction.toml --out friction",
            "cdia campaign friction.toml --scheduler tcp://10.0.0.7:8786",
            "cdia campaign friction --replay 17 --report run.html",
        ],
    ),
    (
        tune,
        MANY,
        [
            "cdia tune friction.toml --false-alarms 0.1",
            "cdia tune friction.toml --false-alarms 1 --out tuned --json tuned.json",
        ],
    ),
    (convert, MODELS, ["cdia convert run.db3 run.csv --robot ur10"]),
    (study, MODELS, ["cdia study scara-model", "cdia study thesis --preset physical --out figures"]),
    (robots, KNOWN, ["cdia robots", "cdia robots ur5"]),
    (effects, KNOWN, ["cdia effects", "cdia effects coulomb_friction"]),
):
    app.command(help=unwrapped(command.__doc__ or ""), rich_help_panel=panel, epilog=examples(*example))(
        command
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command ``cdia``.

    Args:
        arguments: What follows ``cdia``; the process's own arguments if omitted.

    Returns:
        Exit code: 0, 2 for bad input, 70 for a fault of the program, 130 if interrupted.
    """
    mend_streams()
    given = list(sys.argv[1:] if arguments is None else arguments)
    for name in THREADS:  # before NumPy is imported: an arm's matrices are small, threads only cost
        os.environ.setdefault(name, "1")
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    command = shlex.join(["cdia", *given])
    try:
        with insistent():
            code = typer.main.get_command(app).main(
                given, prog_name="cdia", standalone_mode=False, obj=command
            )
        sys.stdout.flush()
        if code == INTERRUPTED:  # what typer makes of Ctrl-C
            raise KeyboardInterrupt
    except BrokenPipeError:
        close_stdout()
        return 0
    except BaseException as error:
        if not is_fault(error) and not isinstance(error, KeyboardInterrupt):
            raise
        return _fail(*_said_of(error, command))
    return code if isinstance(code, int) else 0


def _said_of(error: BaseException, command: str) -> tuple[str, int]:
    """Return the line that is printed for an error, and the exit code."""
    if isinstance(error, UsageError):
        return _usage(error), BAD_INPUT
    if isinstance(error, CdiaError | MemoryError):
        return one_line(error), BAD_INPUT
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror or one_line(error)}", BAD_INPUT
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return "interrupted", INTERRUPTED
    return fault_sentence(error, command), FAULT


def _fail(message: str, code: int) -> int:
    print(f"cdia: error: {printable(clipped(message, LONGEST_MESSAGE))}", file=sys.stderr)
    return code


def _usage(error: Any) -> str:
    message = " ".join(error.format_message().split()).rstrip(".")
    command = error.ctx.command_path if error.ctx else "cdia"
    return f"{message[:1].lower()}{message[1:]}; see {command} --help"
