"""The floors of the house: who may import whom."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from camwright.jobs.wording import place_of
from camwright.profiles.machines import MACHINES
from camwright.profiles.message import HOLE

ROOT = Path(__file__).resolve().parents[2]


def imported(folder: str) -> set[str]:
    """Names of the floors and of other top-level packages that a folder imports, wherever in its modules."""
    names: set[str] = set()
    for file in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {_package(alias.name) for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(_package(node.module))
    return names


def _package(module: str) -> str:
    """Name the floor of a module of the house, ``camwright`` for the front door; of others the top-level package."""
    parts = module.split(".")
    return parts[1] if parts[0] == "camwright" and parts[1] in ("profiles", "design", "validation") else parts[0]


def test_the_contracts_hold() -> None:
    run = subprocess.run(
        [
            sys.executable,
            "-c",
            "from importlinter.cli import lint_imports_command; lint_imports_command()",
            "--no-cache",
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert "0 broken" in run.stdout


@pytest.mark.parametrize(
    ("folder", "forbidden"),
    [
        ("profiles", {"design", "validation", "camwright"}),
        ("design", {"validation", "camwright"}),
        ("validation", {"design", "camwright"}),
    ],
)
def test_no_floor_knows_those_above_or_beside_it(folder: str, forbidden: set[str]) -> None:
    assert not imported(folder) & forbidden


@pytest.mark.parametrize("folder", ["profiles", "validation", "camwright"])
def test_only_design_knows_casadi(folder: str) -> None:
    assert "casadi" not in imported(folder)
    assert "casadi" in imported("design")


@pytest.mark.parametrize("folder", ["profiles", "design", "validation"])
def test_only_the_front_door_shows_things(folder: str) -> None:
    assert not imported(folder) & {"matplotlib", "rich", "typer", "pint", "pydantic"}


def _modules_that_must_not_know_machines() -> list[Path]:
    """Give all modules of the four packages but the machines themselves, and the one that gives them their public names."""
    found = []
    for folder in ("camwright", "profiles", "design", "validation"):
        for file in (ROOT / folder).rglob("*.py"):
            inside = file.relative_to(ROOT).parts
            named = inside == ("camwright", "__init__.py")
            if not named and inside[:2] != ("profiles", "machines") and "machines" not in inside[:-1]:
                found.append(file)
    assert len(found) > 200
    return found


def _names(node: ast.AST) -> set[str]:
    """Names that an expression is made of, attributes included."""
    found = {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}
    return found | {each.attr for each in ast.walk(node) if isinstance(each, ast.Attribute)}


@pytest.mark.parametrize("folder", ["profiles", "design", "validation"])
def test_the_lower_floors_do_not_speak_of_job_files(folder: str) -> None:
    """What they name in a message the front door knows a place for; they name no table of a job file themselves."""
    tables = "|".join(("cut", "limits", "machine", "servo", "objective", "output"))
    faults, named = [], set()
    for file in sorted((ROOT / folder).rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        texts = [
            each.value for each in ast.walk(tree) if isinstance(each, ast.Constant) and isinstance(each.value, str)
        ]
        faults += [f"{file.name}: {text}" for text in texts if re.search(rf"\[({tables})(\.\w+)?\]", text)]
        named |= {name for text in texts for sign, name in HOLE.findall(text) if sign and name}
    assert faults == []
    assert (len(named) > 2) == (folder != "validation")
    for name in named - {"quantity"}:  # that stands for any in what says how a message is written
        assert re.fullmatch(r"\[\w+\] \w+", place_of(name)), name


def test_nobody_asks_what_kind_a_machine_is() -> None:
    """A machine is written once: no isinstance of one, no import of one, no comparison with the name of one outside its own room."""
    concrete = {machine.__name__ for machine in MACHINES.values()}
    faults = []
    for file in _modules_that_must_not_know_machines():
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            place = f"{file.relative_to(ROOT)}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.Call) and _names(node.func) & {"isinstance", "issubclass"}:
                faults += [place] if _names(node.args[1]) & {"Machine", *concrete} else []
            elif isinstance(node, ast.ImportFrom):
                faults += [place] if {alias.name for alias in node.names} & concrete else []
            elif isinstance(node, ast.Compare):
                words = {each.value for each in ast.walk(node) if isinstance(each, ast.Constant)}
                faults += [place] if words & set(MACHINES) else []
    assert faults == []


def test_reading_a_profile_loads_nothing_heavy() -> None:
    """Importing the ground floor must not cost what only some commands need."""
    code = "import sys, camwright.profiles.returns, camwright.profiles.servo; print(*{name.partition('.')[0] for name in sys.modules})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert not set(run.stdout.split()) & {"casadi", "matplotlib", "pint", "pydantic", "rich", "scipy", "typer"}


def modules() -> dict[str, ast.Module]:
    """Every module of the four packages, by its path below the root."""
    files = [
        file for folder in ("camwright", "profiles", "design", "validation") for file in (ROOT / folder).rglob("*.py")
    ]
    linked = {ROOT / "camwright" / floor for floor in ("profiles", "design", "validation")}
    return {
        file.relative_to(ROOT).as_posix(): ast.parse(file.read_text(encoding="utf-8"))
        for file in files
        if linked.isdisjoint(file.parents)
    }


def waits(node: ast.AST) -> bool:
    """Whether a statement imports a module of the house."""
    if isinstance(node, ast.Import):
        return any(alias.name.partition(".")[0] == "camwright" for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        return node.level > 0 or (node.module or "").partition(".")[0] == "camwright"
    called = node.func if isinstance(node, ast.Call) else None
    return (called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")) in (
        "import_module",
        "__import__",
    )


def test_own_modules_are_imported_at_the_top() -> None:
    """The table of commands and the table of public names are the only places where an import waits."""
    waiting = {
        f"{path}: {function.name}"
        for path, tree in modules().items()
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        if any(waits(node) for node in ast.walk(function))
    }
    assert waiting == {"camwright/cli/main.py: _command", "camwright/__init__.py: __getattr__"}


def test_own_modules_are_imported_for_good() -> None:
    """An import for type checkers only would hide a circle or a heavy module that the run meets elsewhere."""
    hidden = [
        path
        for path, tree in modules().items()
        for node in tree.body
        if isinstance(node, ast.If) and any(waits(inner) for inner in ast.walk(node))
    ]
    assert hidden == ["camwright/__init__.py"]


def attributes(kind: ast.ClassDef) -> set[str]:
    """Attributes of an object that its methods set, or, of a dataclass that is not frozen, anybody."""
    marks = [ast.unparse(decorator) for decorator in kind.decorator_list if "dataclass" in ast.unparse(decorator)]
    fields = {
        node.target.id for node in kind.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }
    stored = {
        node.attr
        for node in ast.walk(kind)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
        if isinstance(node.value, ast.Name) and node.value.id == "self"
    }
    return stored | (fields if any("frozen=True" not in mark for mark in marks) else set())


def test_no_class_has_more_than_six_attributes_that_change() -> None:
    many = {
        f"{path}: {node.name}": sorted(attributes(node))
        for path, tree in modules().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and len(attributes(node)) > 6
    }
    assert not many


def test_no_function_branches_more_than_twelve_times() -> None:
    """Ruff counts statements; here every condition counts, those of functions inside a function too."""
    branch = (ast.If, ast.For, ast.While, ast.ExceptHandler, ast.match_case, ast.BoolOp, ast.IfExp)
    many = {
        f"{path}: {node.name}": count
        for path, tree in modules().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if (count := sum(isinstance(inner, branch) for inner in ast.walk(node))) > 12
    }
    assert not many


@pytest.mark.parametrize(("folder", "most"), [("camwright", 3), ("design", 5), ("validation", 7)])
def test_few_modules_lie_outside_the_rooms(folder: str, most: int) -> None:
    assert len([file for file in (ROOT / folder).glob("*.py") if file.name != "__init__.py"]) <= most


def test_files_are_put_in_their_place_by_one_module() -> None:
    moving = {"replace", "rename", "renames", "fsync", "move", "mkdtemp"}
    elsewhere = {
        f"{path}: {node.func.value.id}.{node.func.attr}"
        for path, tree in modules().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in moving
        if isinstance(node.func.value, ast.Name) and node.func.value.id in ("os", "shutil", "tempfile")
        if path != "camwright/house/files.py"
    }
    assert not elsewhere
