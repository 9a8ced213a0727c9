"""The command line: the commands about one job, and the others from their modules."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from camwright.cli.bend import bend
from camwright.cli.book import book
from camwright.cli.envelope import envelope
from camwright.cli.identify import identify
from camwright.cli.quick import quick
from camwright.cli.recipe import register as register_recipes
from camwright.cli.tables import register
from camwright.house.output import (
    BROKEN_PIPE,
    Voice,
    complain,
    prepare_streams,
    silence_stdout,
)
from camwright.profiles.errors import CamwrightError, InputError

if TYPE_CHECKING:
    from rich.console import RenderableType

    from camwright.jobs.job import Job

INTERRUPTED = 130
"""Exit code when the user stops the command, as a shell reports it."""

# typer's own usage error, which depending on its version is click's or typer's copy of it
_UsageError = cast("type[Exception]", typer.BadParameter.__base__)

app = typer.Typer(
    name="camwright",
    help="Optimal electronic cams for cut-to-length machines: designed, proved, and written for the drive.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

_Job = Annotated[Path | None, typer.Argument(metavar="[JOB]", help="Job file (TOML); the paper's job if left out.")]
_GivenJob = Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).")]
_Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<name> if left out.")]
_Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]
_NoFigures = Annotated[bool, typer.Option("--no-figures", help="Write no figures.")]
_Quiet = Annotated[bool, typer.Option("--quiet", help="Print neither tables nor progress.")]


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
) -> None:
    """Print the version if asked."""
    if version:
        from camwright.house.provenance import camwright_version

        sys.stdout.write(f"camwright {camwright_version()}\n")
        context.exit()


@app.command("design")
def _design(
    job: _Job = None,
    out: _Out = None,
    as_json: _Json = False,
    no_figures: _NoFigures = False,
    quiet: _Quiet = False,
) -> int:
    """Design the optimal cam of a job; write the design, the cam table and the figures."""
    from camwright.answers.studies import design_answer
    from camwright.house.files import staged
    from camwright.jobs.job import load_job
    from camwright.stored.design_file import design_text
    from camwright.stored.profile_files import cam_text
    from camwright.studies.comparison import law_names
    from camwright.studies.design import STEPS, optimise

    asked = load_job(job)
    directory = _directory(out, asked)
    voice = Voice(as_json, quiet)
    with voice.progress(STEPS + len(law_names(asked.machine, asked.cut)) + 2) as step:
        result = optimise(asked, step)
        texts = {"design.json": design_text(result), "cam.csv": cam_text(result)}
        step("writing files")
        with staged(directory) as aside:
            for name, text in texts.items():
                (aside / name).write_bytes(text.encode())
            if not no_figures:
                from camwright.figures import design_figures

                design_figures(result, aside)
            files = _placed(aside, directory)

    def view() -> RenderableType:
        from camwright.cli.views import design_view

        return design_view(result, files)

    voice.answer(lambda: design_answer(result, files), view)
    return 0 if result.passed else 1


@app.command("compare")
def _compare(
    job: _GivenJob,
    laws: Annotated[
        list[str] | None, typer.Option("--with", metavar="LAW", help="Compare with this law only; may be repeated.")
    ] = None,
    objectives: Annotated[
        bool, typer.Option("--objectives", help="Compare what every objective costs in the others instead.")
    ] = False,
    out: _Out = None,
    as_json: _Json = False,
    no_figures: _NoFigures = False,
    quiet: _Quiet = False,
) -> int:
    """Compare the optimal cam with the linear return and the standard motion laws."""
    from camwright.answers.studies import compare_answer
    from camwright.house.files import staged
    from camwright.jobs.job import load_job
    from camwright.studies.comparison import compare, law_names, require_laws
    from camwright.studies.screw import with_screw

    asked = load_job(job)
    if objectives:
        from camwright.cli.objectives import compare_objectives

        if laws:
            raise InputError("--objectives compares all laws; leave out --with")
        return compare_objectives(asked, _directory(out, asked), figures=not no_figures, voice=Voice(as_json, quiet))
    names = tuple(dict.fromkeys(laws)) if laws else law_names(asked.machine, asked.cut)
    require_laws(names, asked.machine, asked.cut)
    voice = Voice(as_json, quiet)
    files: list[Path] = []
    with voice.progress(len(names) + 3) as step:
        from camwright.studies.axis_study import solve_job

        step("solving")
        solution = solve_job(asked)
        result = with_screw(compare(replace(asked, machine=solution.machine), solution.profile, names, step))
        if not no_figures:
            from camwright.figures import comparison_figure

            step("writing files")
            directory = _directory(out, asked)
            with staged(directory) as aside:
                comparison_figure(result, aside)
                files = _placed(aside, directory)

    def view() -> RenderableType:
        from rich.console import Group

        from camwright.cli.views import compare_view, files_view

        return Group(compare_view(result), files_view(files))

    voice.answer(lambda: compare_answer(result, files), view)
    return 0


@app.command("limits")
def _limits(job: _GivenJob, as_json: _Json = False, quiet: _Quiet = False) -> int:
    """Say how fast and how short the machine of a job can cut, and which limit binds."""
    from camwright.answers.studies import limits_answer
    from camwright.jobs.job import load_job
    from camwright.studies.axis_lengths import axis_lengths
    from camwright.studies.cut_lengths import cut_lengths

    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(3) as step:
        from camwright.design.feasible.extremes import extremes

        step("finding the highest line speed and the shortest cut")
        far = extremes(asked.task)
        step("finding minimum cut lengths")
        lengths = cut_lengths(asked)
        step("finding minimum cut lengths with the axis in sync")
        axis = axis_lengths(asked)

    def view() -> RenderableType:
        from camwright.cli.views import limits_view

        return limits_view(asked, far, lengths, axis)

    voice.answer(lambda: limits_answer(asked, far, lengths, axis), view)
    return 0


@app.command("validate")
def _validate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A design.json, or a table with x and y as CSV.")],
    job: Annotated[Path, typer.Option("--job", metavar="JOB", help="Job file (TOML) to judge it by.")],
    as_json: _Json = False,
    quiet: _Quiet = False,
) -> int:
    """Judge a cam, camwright's or anyone's, by a job's machine, limits and servo."""
    from camwright.answers.studies import validate_answer
    from camwright.jobs.job import load_job
    from camwright.stored.judge import validate

    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("checking")
        report = validate(file, asked)

    def view() -> RenderableType:
        from camwright.cli.views import validate_view

        return validate_view(asked, file, report)

    voice.answer(lambda: validate_answer(asked, file, report), view)
    return 0 if report.passed else 1


@app.command("check")
def _check(job: _GivenJob, as_json: _Json = False, quiet: _Quiet = False) -> int:
    """Read a job file and say whether it has faults."""
    from camwright.answers.studies import check_answer
    from camwright.jobs.job import load_job

    asked = load_job(job)

    def view() -> RenderableType:
        from camwright.cli.views import check_view

        return check_view(asked)

    Voice(as_json, quiet).answer(lambda: check_answer(asked), view)
    return 0


app.command("quick")(quick)
app.command("envelope")(envelope)
app.command("identify")(identify)
app.command("book")(book)
register(app)
register_recipes(app)
app.command("bend")(bend)


def _directory(out: Path | None, job: Job) -> Path:
    """Where the files of a job go."""
    return Path("out") / job.name if out is None else out


def _placed(aside: Path, directory: Path) -> list[Path]:
    """Paths that the files aside will have."""
    return [directory / name for name in sorted(file.name for file in aside.iterdir())]


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
        return int(app(arguments, prog_name="camwright", standalone_mode=False) or 0)
    except CamwrightError as error:
        exit_code, message, failure = error.exit_code, str(error), error
    except _UsageError as error:
        exit_code, message, failure = 2, cast("typer.BadParameter", error).format_message(), None
    if "--json" in arguments:
        from camwright.answers.studies import error_answer
        from camwright.house.json_text import to_json

        sys.stdout.write(to_json(error_answer(exit_code, message, failure)))
        sys.stdout.flush()
    for line in message.splitlines():
        complain(f"camwright: {line}")
    return exit_code
