"""The documents: their Python runs, their commands print what they quote, their paths and pictures are there."""

from __future__ import annotations

import contextlib
import doctest
import importlib.util
import io
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from camwright.cli.commands import COMMANDS
from camwright.cli.main import main
from camwright.jobs.keys import job_keys

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LEFT_OUT = "…"


def blocks(document: Path, language: str) -> list[str]:
    return [body for found, body in FENCE.findall(document.read_text()) if found == language]


def with_blocks(language: str) -> list[object]:
    return [pytest.param(file, id=file.relative_to(ROOT).as_posix()) for file in DOCUMENTS if blocks(file, language)]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a working directory like that of a reader, with the examples in it."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("document", with_blocks("python"))
def test_python_of_a_document_runs_and_answers_as_quoted(document: Path, workplace: Path) -> None:
    names: dict[str, object] = {}
    for number, body in enumerate(blocks(document, "python"), start=1):
        if ">>>" not in body:
            exec(compile(body, f"{document.name}, block {number}", "exec"), names)  # noqa: S102 - our own documents
            continue
        test = doctest.DocTestParser().get_doctest(body, names, f"{document.name}, block {number}", str(document), 0)
        said = io.StringIO()
        failed = doctest.DocTestRunner(verbose=False).run(test, out=said.write, clear_globs=False).failed
        assert not failed, said.getvalue()
        names = test.globs


def run(command: str) -> list[str]:
    """Run a command of a document; the lines that it prints, on both streams."""
    words = command.split()
    if words[0] != "camwright":
        done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=True)
        return (done.stdout + done.stderr).splitlines()
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        main(words[1:])
    return (out.getvalue() + err.getvalue()).splitlines()


def same(quoted: str, printed: str) -> bool:
    """Whether two lines are word by word the same; numbers may differ by one in a thousand, tiny ones altogether."""
    left, right = quoted.split(), printed.split()
    return len(left) == len(right) and all(a == b or _near(a, b) for a, b in zip(left, right, strict=True))


def _near(left: str, right: str) -> bool:
    try:
        a, b = float(left), float(right)
    except ValueError:
        return False
    return abs(a - b) <= 1e-3 * abs(a) or max(abs(a), abs(b)) < 1e-8


def difference(quoted: list[str], printed: list[str]) -> str:
    """Say which quoted line is not printed where it should be; an ellipsis stands for any number of lines."""
    at, skip = 0, False
    for line in quoted:
        if line == LEFT_OUT:
            skip = True
            continue
        while skip and at < len(printed) and not same(line, printed[at]):
            at += 1
        if at == len(printed) or not same(line, printed[at]):
            return (
                f"quoted, but not printed: {line!r}; printed: {printed[at] if at < len(printed) else 'nothing more'!r}"
            )
        at, skip = at + 1, False
    return "" if skip or at == len(printed) else f"printed, but not quoted: {printed[at]!r}"


@pytest.mark.parametrize("document", with_blocks("console"))
def test_commands_of_a_document_print_what_it_quotes(document: Path, workplace: Path) -> None:
    for body in blocks(document, "console"):
        for part in body.removeprefix("$ ").split("\n$ "):
            command, *quoted = part.rstrip("\n").split("\n")
            assert not (found := difference(quoted, run(command))), f"{document.name}, $ {command}: {found}"


@pytest.mark.parametrize(
    ("quoted", "printed", "fault"),
    [
        (["a 1.0"], ["a  1.0004"], ""),
        (["a 1.0"], ["a 1.01"], "quoted, but not printed: 'a 1.0'; printed: 'a 1.01'"),
        (["gap 1e-10"], ["gap -3e-16"], ""),
        (["a", "…", "c"], ["a", "b", "c"], ""),
        (["a"], ["a", "b"], "printed, but not quoted: 'b'"),
        (["a", "…"], ["a", "b"], ""),
        (["…", "c"], ["a"], "quoted, but not printed: 'c'; printed: 'nothing more'"),
    ],
)
def test_a_wrong_quotation_is_noticed(quoted: list[str], printed: list[str], fault: str) -> None:
    assert difference(quoted, printed) == fault


def test_the_readmes_test_command_is_what_ci_runs() -> None:
    commands = [line.strip() for body in blocks(ROOT / "README.md", "sh") for line in body.splitlines()]
    script = (ROOT / ".ci" / "run").read_text().replace('"$python"', "python3").splitlines()
    tests = [command for command in commands if "pytest" in command]
    assert len(commands) == 2
    assert len(tests) == 1
    assert tests[0] in (line.strip() for line in script)


@pytest.mark.parametrize("document", [pytest.param(file, id=file.relative_to(ROOT).as_posix()) for file in DOCUMENTS])
def test_links_pictures_and_paths_of_a_document_are_there(document: Path) -> None:
    text = document.read_text()
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if not link.startswith("http")]
    paths = re.findall(r"`((?:camwright|design|profiles|validation|tests|docs|examples)/[\w./-]*)`", text)
    missing = [link for link in links if not (document.parent / link).exists()]
    missing += [path for path in paths if not (ROOT / path).exists()]
    assert missing == []


def test_the_generated_pages_are_what_the_code_says() -> None:
    """Keys and commands of the reference are made from the schema and the command line: ``python docs/generate.py``."""
    spec = importlib.util.spec_from_file_location("generate", ROOT / "docs" / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for path, text in module.pages().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name}: run python docs/generate.py"
    commands = (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
    assert all(f"## `camwright {name}`" in commands for name in COMMANDS)
    keys = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")
    assert all(f"| `{key.name}` |" in keys for key in job_keys())
