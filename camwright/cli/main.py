"""The command line: the command that is called, and what its errors mean to the caller.

The module of a command is imported when it is called: the one place where an import waits, so that help and ``--version`` need not.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, cast

import typer

from camwright.answers.error import error_answer
from camwright.cli.commands import COMMANDS
from camwright.house.files import require_no_file
from camwright.house.json_text import to_json
from camwright.house.output import BROKEN_PIPE, complain, prepare_streams, silence_stdout
from camwright.house.provenance import camwright_version
from camwright.house.threads import ask_for_one_thread
from camwright.jobs.wording import error_words, unforeseen
from camwright.profiles.errors import CamwrightError, InputError, SolverError

INTERRUPTED = 130
"""Exit code when the user stops the command, as a shell reports it."""

_ONE_FILE = {"identify", "new"}
"""Commands whose ``--out`` names a file."""

# typer's own usage error, which depending on its version is click's or typer's copy of it
_UsageError = cast("type[Exception]", typer.BadParameter.__base__)


def _application(arguments: Sequence[str]) -> typer.Typer:
    """Build the command line for a call: the command that is called from its module, of the others the names and what they do."""
    called = next((argument for argument in arguments if not argument.startswith("-")), "")
    application = typer.Typer(
        name="camwright",
        help="Optimal electronic cams for cut-to-length machines: designed, proved, and written for the drive.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    application.callback(invoke_without_command=True)(_root)
    for name, command in COMMANDS.items():
        application.command(
            name, help=command.does, epilog=f"Example: {_escaped(command.example)}", rich_help_panel=command.task
        )(_command(name) if name == called else _uncalled)
    return application


def _called(arguments: Sequence[str]) -> Sequence[str]:
    """Take the words of a call: those of the command line, or those that a shell asks to complete."""
    asked = os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS")
    return asked.split()[1:] if asked and os.environ.get("_CAMWRIGHT_COMPLETE") else arguments


def _escaped(text: str) -> str:
    """Write a text so that its brackets are no markup; rich's own function would load rich for every command."""
    return text.replace("[", r"\[")


def _command(name: str) -> Callable[..., int]:
    """Import a command.

    What is imported stays: to look through it for what could go, again and again, takes a tenth of the time.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        return cast("Callable[..., int]", import_module(f"camwright.cli.{name}").run)
    finally:
        if collects:
            gc.enable()


def _uncalled() -> int:
    """Stand for a command in the help of all commands."""
    raise AssertionError("only the command that is called is run")


def _root(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
) -> None:
    """Print the version if asked."""
    if version:
        sys.stdout.write(f"camwright {camwright_version()}\n")
        context.exit()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        What follows the command's name; that of the process if not given.

    Returns
    -------
    int
        0 done and every check passed; 1 done, but a check failed; 2 bad input; 3 infeasible; 4 the solver failed, or camwright itself; 130
        interrupted; 141 the reader of standard output is gone.
    """
    prepare_streams()
    ask_for_one_thread()
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments))
    except (KeyboardInterrupt, typer.Abort):
        return INTERRUPTED
    except BrokenPipeError:
        silence_stdout()
        return BROKEN_PIPE
    except OSError as error:  # reading and writing files raise InputError: only standard output is left
        silence_stdout()
        complain(f"camwright: the answer cannot be written to standard output: {error.strerror}")
        return 2


def _require_output(arguments: Sequence[str]) -> None:
    """Refuse ``--out ""``, which as a path is the working directory: a variable of a script that was never set; and a file for a folder.

    A folder that cannot be made is refused here because the work that comes first may take minutes.

    Raises
    ------
    InputError
        The name is empty, or a file stands in the folder's place.
    """
    for number, argument in enumerate(arguments):
        name, sign, value = argument.partition("=")
        given = value if sign else next(iter(arguments[number + 1 :]), None)
        if name == "--out" and given is not None and not given.strip():
            raise InputError("--out: the name is empty; name where to write to, or leave --out out")
        if name == "--out" and given is not None and _ONE_FILE.isdisjoint(arguments[:1]):
            require_no_file(Path(given))


def _run(arguments: list[str]) -> int:
    """Run a command; the exit code, errors told."""
    failure: CamwrightError | None
    try:
        _require_output(arguments)
        return int(_application(_called(arguments))(arguments, prog_name="camwright", standalone_mode=False) or 0)
    except CamwrightError as error:
        exit_code, message, failure = error.exit_code, "\n".join(error_words(error)), error
    except _UsageError as error:
        exit_code, message, failure = 2, cast("typer.BadParameter", error).format_message(), None
    except typer.Abort:
        raise
    except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError) as error:
        exit_code, message, failure = SolverError.exit_code, unforeseen(error), None
    if "--json" in arguments:
        sys.stdout.write(to_json(error_answer(exit_code, message, failure)))
        sys.stdout.flush()
    for line in message.splitlines():
        complain(f"camwright: {line}")
    return exit_code
