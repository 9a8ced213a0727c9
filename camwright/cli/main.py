"""The command line: the table of commands, and what their errors mean to the caller."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Annotated, cast

import typer

from camwright.answers.error import error_answer
from camwright.house.json_text import to_json
from camwright.house.output import BROKEN_PIPE, complain, prepare_streams, silence_stdout
from camwright.house.provenance import camwright_version
from camwright.jobs.wording import error_words
from camwright.profiles.errors import CamwrightError

COMMANDS = {
    "new": "Start a job: a commented file with every key, your numbers in it, an example's where you give none.",
    "examples": "List the example jobs, or write one as a file.",
    "keys": "List the keys of a job file: what each takes, its default, what it means and what uses it.",
    "schema": "Print the JSON Schema of job files, of design.json or of recipe.json, for editors and other programs.",
    "design": "Design the optimal cam of a job; write the design, the cam table and the figures.",
    "compare": "Compare the optimal cam with the linear return and the standard motion laws.",
    "limits": "Say how fast and how short the machine of a job can cut, and which limit binds.",
    "validate": "Judge a cam, camwright's or anyone's, by a job's machine, limits and servo.",
    "check": "Read a job file and say whether it has faults.",
    "quick": "Make the patent's quintic cam of a rotary cross-cutter from three lengths.",
    "envelope": "Map which cut lengths and line speeds are possible, with which return, and what binds.",
    "identify": "Find the servo's parameters from a recorded trace.",
    "book": "Design every combination of cut lengths, line speeds and objectives, check it, write its tables, and an index.",
    "export": "Write a design for drives; every file is read back and judged as the drive will run it.",
    "audit": "Judge a cam that runs today as its drive runs it, and set it beside the optimum of the same job.",
    "targets": "List the targets: limits, interpolation, evidence, and what was never tested on a controller.",
    "recipe": "Make the recipe of a product: a folder with all that is needed at the machine.",
    "verify": "Prove that a recipe folder is what was written, and that its tables are the motion that it promises.",
    "bend": "Turn a drawing of die lines into proved NC programs of a rule bender.",
}
"""What each command does, in the order of the help. Its module is `camwright.cli.<name>` and is imported when the command is called:
the one place where an import waits, so that help and ``--version`` need not."""

INTERRUPTED = 130
"""Exit code when the user stops the command, as a shell reports it."""

# typer's own usage error, which depending on its version is click's or typer's copy of it
_UsageError = cast("type[Exception]", typer.BadParameter.__base__)


def _application(arguments: Sequence[str]) -> typer.Typer:
    """Build the command line for a call: the command that is called from its module, of the others the names and what they do."""
    called = next((argument for argument in arguments if not argument.startswith("-")), "")
    application = typer.Typer(
        name="camwright",
        help="Optimal electronic cams for cut-to-length machines: designed, proved, and written for the drive.",
        add_completion=False,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    application.callback(invoke_without_command=True)(_root)
    for name, does in COMMANDS.items():
        application.command(name, help=does)(_command(name) if name == called else _uncalled)
    return application


def _command(name: str) -> Callable[..., int]:
    """Import a command."""
    return cast("Callable[..., int]", import_module(f"camwright.cli.{name}").run)


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
        0 done and every check passed; 1 done, but a check failed; 2 bad input; 3 infeasible; 4 the solver failed; 130
        interrupted; 141 the reader of standard output is gone.
    """
    prepare_streams()
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


def _run(arguments: list[str]) -> int:
    """Run a command; the exit code, errors told."""
    failure: CamwrightError | None
    try:
        return int(_application(arguments)(arguments, prog_name="camwright", standalone_mode=False) or 0)
    except CamwrightError as error:
        exit_code, message, failure = error.exit_code, "\n".join(error_words(error)), error
    except _UsageError as error:
        exit_code, message, failure = 2, cast("typer.BadParameter", error).format_message(), None
    if "--json" in arguments:
        sys.stdout.write(to_json(error_answer(exit_code, message, failure)))
        sys.stdout.flush()
    for line in message.splitlines():
        complain(f"camwright: {line}")
    return exit_code
