"""The public names of camwright: each is there, has an example that runs, and does what the command of its name does."""

from __future__ import annotations

import ast
import doctest
import importlib
import inspect
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import camwright
from camwright import (
    Cut,
    Design,
    InputError,
    Job,
    Limits,
    RotaryKnife,
    Servo,
    audit,
    compare,
    export,
    limits,
    load_job,
    optimise,
    read_design,
    recipe,
    save,
    validate,
)
from camwright.stored.design_file import StoredDesign

PROMISED = [
    *(
        "Job",
        "load_job",
        "optimise",
        "validate",
        "compare",
        "limits",
        "export",
        "audit",
        "recipe",
        "save",
        "read_design",
        "baseline",
    ),
    *(
        "RotaryKnife",
        "LinearCarriage",
        "CrankSlider",
        "Machine",
        "Cut",
        "Limits",
        "Servo",
        "Objective",
        "Task",
        "Design",
        "Result",
    ),
    *("CamwrightError", "InputError", "InfeasibleError", "SolverError", "MissingExtraError"),
]


@pytest.fixture(scope="module")
def result() -> Design:
    return optimise(load_job())


def test_the_names_are_those_promised() -> None:
    assert sorted(camwright.__all__) == sorted(PROMISED)


def test_type_checkers_see_the_same_homes() -> None:
    tree = ast.parse(Path(camwright.__file__).read_text(encoding="utf-8"))
    seen = {
        name.name: node.module
        for block in tree.body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for name in node.names
    }
    assert seen == camwright._HOMES
    assert sorted(camwright.__all__) == sorted(seen)


@pytest.mark.parametrize("name", PROMISED)
def test_every_name_has_an_example_that_runs(name: str) -> None:
    found = getattr(camwright, name)
    assert found.__name__ == name
    document = inspect.getdoc(found)
    assert document is not None
    module = importlib.import_module(found.__module__)
    examples = doctest.DocTestFinder(recurse=True).find(found, name, module=module)
    asked = [example for example in examples if example.examples]
    assert asked
    for example in asked:
        failed, _ = doctest.DocTestRunner(verbose=False).run(example)
        assert failed == 0, example.name


def test_a_name_is_what_it_is_whatever_was_imported_before() -> None:
    code = (
        "import camwright.recipes.write, camwright\n"
        "print([name for name in camwright.__all__ if not callable(getattr(camwright, name))])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_importing_camwright_imports_no_library() -> None:
    code = "import sys, camwright; print([name for name in ('numpy', 'casadi', 'scipy', 'pydantic', 'pint') if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(AttributeError, match="module 'camwright' has no attribute 'optimize'"):
        camwright.optimize  # type: ignore[attr-defined] # noqa: B018


def test_from_a_job_of_ones_own_to_files(tmp_path: Path) -> None:
    job = Job.of(
        "own",
        RotaryKnife(0.5),
        Cut(0.7, 1.0, 0.2, 0.04, 0.16, 1e-4),
        Limits(3.0, 40.0, 4000.0),
        Servo(120.0, 0.7, 35.0, 0.004, 1.0),
    )
    made = optimise(job)
    design, table = save(made, tmp_path)
    stored = read_design(design)
    assert stored.job == made.job
    assert stored.job.text == job.text
    assert validate(table, job).motion.peak_acceleration == pytest.approx(made.objective, rel=1e-9)
    written = export(stored, "csv", tmp_path / "tables")
    assert written.passed
    assert all(file.is_file() for file in written.files)
    assert audit(written.files[0], job).judgement.passed


def test_comparing_designs_the_job_or_takes_a_cycle(result: Design) -> None:
    assert compare(result.job, names=["cycloid"])["optimised"].motion == result.comparison["optimised"].motion
    assert [row.name for row in compare(result.job, result.profile, ["cycloid"]).rows] == ["optimised", "cycloid"]


def test_limits_are_those_that_designing_meets() -> None:
    job = load_job()
    speed = limits(job).far.max_line_speed
    assert speed is not None
    assert optimise(replace(job, cut=replace(job.cut, line_speed=0.9999 * speed))).solution.status.value == "optimal"
    with pytest.raises(camwright.InfeasibleError):
        optimise(replace(job, cut=replace(job.cut, line_speed=1.001 * speed)))


def test_a_target_that_is_none_is_refused_and_nothing_written(result: Design, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nonsense"):
        export(result, ["nonsense"], tmp_path / "tables")
    assert not (tmp_path / "tables").exists()


def test_all_targets_name_those_that_cannot_take_the_cam(result: Design, tmp_path: Path) -> None:
    written = export(result, "all", tmp_path)
    assert {each.target.name for each in written.results}.isdisjoint(written.refused)
    assert written.files[-1].name == "report.json"


def test_a_recipe_of_a_design_and_of_what_was_read_are_the_same(result: Design, tmp_path: Path) -> None:
    recipe(result, tmp_path / "a")
    recipe(StoredDesign(result.profile, result.job), tmp_path / "b")
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*") if path.is_file())
    assert files
    assert all((tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes() for file in files)
