"""What is built and installed: one name, the same from any checkout, and never in the way of a user's own files."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINKED = ("design", "examples", "profiles", "validation")
PAPERS = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "CITATION.cff", "LICENSE", "pyproject.toml")
NOT_COPIED = shutil.ignore_patterns(".venv", ".git", "out", "dist", ".*_cache", ".hypothesis", "__pycache__")
WITHOUT_INDEX = (
    "--ignore-installed",
    "--no-deps",
    "--no-index",
    "--no-build-isolation",
    "--disable-pip-version-check",
    "--quiet",
)


def copied(target: Path, links: bool) -> Path:
    """Copy the checkout, with its four links or with what a checkout without links has: text files that name the folder."""
    shutil.copytree(ROOT, target, ignore=NOT_COPIED, symlinks=True)
    for name in LINKED:
        link = target / "camwright" / name
        link.unlink()
        if links:
            link.symlink_to(f"../{name}", target_is_directory=True)
        else:
            link.write_text(f"../{name}", encoding="utf-8")
    return target


def built(kind: str, checkout: Path, out: Path) -> Path:
    """Build ``wheel`` or ``sdist`` of a checkout, and give the file."""
    run([sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(out)], cwd=checkout)
    (file,) = (path for path in out.iterdir() if path.name.endswith(".whl" if kind == "wheel" else ".tar.gz"))
    return file


def run(command: Sequence[str | Path], cwd: Path, **environment: str) -> str:
    """Run a command without the checkout on its path; give what it says, or fail with what it says."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env=kept | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def fresh(place: Path, *what: str | Path) -> Path:
    """Make an environment that sees the libraries of this one, install into it, and give its Python."""
    venv.create(place, with_pip=False)
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    # lines of a .pth file are added to the path; a .pth file in these folders is not read again, so no camwright comes with them
    libraries = [path for path in sys.path if path.endswith("site-packages")]
    (site_packages(python) / "libraries.pth").write_text("\n".join(libraries), encoding="utf-8")
    run([sys.executable, "-m", "pip", "--python", python, "install", *WITHOUT_INDEX, *what], cwd=place)
    return python


def site_packages(python: Path) -> Path:
    return Path(run([python, "-c", "import site; print(site.getsitepackages()[-1])"], cwd=python.parent).strip())


def sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


@pytest.fixture(scope="module")
def linked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return copied(tmp_path_factory.mktemp("linked") / "camwright-checkout", links=True)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return copied(tmp_path_factory.mktemp("plain") / "camwright-checkout", links=False)


@pytest.fixture(scope="module")
def wheel(plain: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built("wheel", plain, tmp_path_factory.mktemp("wheel"))


@pytest.fixture
def crowded(tmp_path: Path) -> Path:
    """Make a user's folder with files of the names that the floors have; importing one of them is an error."""
    folder = tmp_path / "user"
    (folder / "profiles").mkdir(parents=True)
    for name in ("design.py", "validation.py", "profiles/__init__.py"):
        (folder / name).write_text(f"raise SystemExit('the user\\'s {name} was imported')\n", encoding="utf-8")
    return folder


def test_the_wheel_is_the_same_with_and_without_links(linked: Path, wheel: Path, tmp_path: Path):
    other = built("wheel", linked, tmp_path)
    assert other.name == wheel.name
    with zipfile.ZipFile(wheel) as one, zipfile.ZipFile(other) as two:
        assert one.namelist() == two.namelist()
    assert sha256(other) == sha256(wheel)


def test_the_wheel_holds_every_module_once_and_installs_one_name(wheel: Path):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert len(names) == len(set(names))
    assert {name.split("/")[0] for name in names if ".dist-info/" not in name} == {"camwright"}
    expected = {
        f"{'' if floor == 'camwright' else 'camwright/'}{path.relative_to(ROOT).as_posix()}"
        for floor in ("camwright", *LINKED)
        for path in (ROOT / floor).rglob("*")  # follows no links
        if path.is_file() and "__pycache__" not in path.parts and path.name not in LINKED
    }
    assert {name for name in names if ".dist-info/" not in name} == expected


def test_beside_files_of_the_same_names_all_works(wheel: Path, crowded: Path, tmp_path: Path):
    python = fresh(tmp_path / "environment", wheel)
    script = crowded / "use.py"
    script.write_text(
        "import camwright, camwright.design, camwright.profiles, camwright.validation\n"
        "result = camwright.optimise(camwright.load_job())\n"
        "print(camwright.__file__, result.report.passed)\n",
        encoding="utf-8",
    )
    # PYTHONPATH puts the folder first even for a command that is installed elsewhere
    where, passed = run([python, "-W", "error", script], cwd=crowded, PYTHONPATH=str(crowded)).split()
    assert Path(where).is_relative_to(tmp_path / "environment")
    assert passed == "True"
    (script_of_command,) = python.parent.glob("camwright*")
    for command in ([script_of_command], [python, "-m", "camwright"]):
        run([*command, "--help"], cwd=crowded, PYTHONPATH=str(crowded))
        said = run([*command, "design", "--json", "--no-figures", "--out", "out"], cwd=crowded, PYTHONPATH=str(crowded))
        assert '"passed": true' in said or '"passed":true' in said
        assert (crowded / "out" / "design.json").exists()
        shutil.rmtree(crowded / "out")


@pytest.mark.parametrize("links", [True, False])
def test_the_source_archive_builds_the_same_wheel(
    links: bool, request: pytest.FixtureRequest, wheel: Path, tmp_path: Path
):
    checkout: Path = request.getfixturevalue("linked" if links else "plain")
    archive = built("sdist", checkout, tmp_path)
    with tarfile.open(archive) as opened:
        opened.extractall(tmp_path / "unpacked", filter="data")
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    assert {path.name for path in unpacked.iterdir()} >= {"camwright", *LINKED, "tests", "benchmarks", "docs", *PAPERS}
    assert sha256(built("wheel", unpacked, tmp_path / "again")) == sha256(wheel)


def test_the_source_archive_installs(plain: Path, crowded: Path, tmp_path: Path):
    python = fresh(tmp_path / "environment", built("sdist", plain, tmp_path))
    (crowded / "numbers.py").write_text("raise SystemExit('the user\\'s numbers.py was imported')\n", encoding="utf-8")
    said = run([python, "-m", "camwright", "check", plain / "examples" / "paper-600.toml"], cwd=crowded)
    assert "paper-600" in said


def test_the_source_archive_passes_its_tests_on_its_own(plain: Path, tmp_path: Path):
    """Tests of several rooms, from the unpacked archive, with what was built of it installed."""
    with tarfile.open(built("sdist", plain, tmp_path)) as opened:
        opened.extractall(tmp_path / "unpacked", filter="data")
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    python = fresh(tmp_path / "environment", unpacked)
    chosen = (
        "tests/house/test_units.py",
        "tests/jobs/test_job.py",
        "tests/profiles/test_laws.py",
        "tests/house/test_release.py",
    )
    said = run([python, "-m", "pytest", "-q", "-p", "no:cacheprovider", *chosen], cwd=unpacked)
    assert " passed" in said
    assert "failed" not in said


def test_an_editable_install_is_the_checkout_and_leaves_no_copy(linked: Path, crowded: Path, tmp_path: Path):
    python = fresh(tmp_path / "environment", "-e", linked)
    code = "import camwright.cli.main as c, camwright.design.optimise as d; print(c.__file__); print(d.__file__)"
    for module in run([python, "-c", code], cwd=crowded).split("\n")[:2]:
        assert Path(module).resolve().is_relative_to(linked.resolve())
    assert not (site_packages(python) / "camwright").exists()


def test_pytest_by_its_own_name_tests_the_checkout(linked: Path, tmp_path: Path):
    """The command ``pytest`` does not put the checkout first on the path, as ``python -m pytest`` does; pyproject.toml does."""
    stale = copied(tmp_path / "stale", links=False)
    (stale / "camwright" / "__init__.py").write_text(
        "raise SystemExit('a stale copy was imported')\n", encoding="utf-8"
    )
    python = fresh(tmp_path / "environment", stale)
    command = python.parent / "pytest"
    command.write_text("import pytest\nraise SystemExit(pytest.console_main())\n", encoding="utf-8")
    (linked / "tests" / "test_where.py").write_text(
        "import subprocess, sys\nfrom pathlib import Path\nimport camwright, camwright.design\n\n"
        "HERE = Path(__file__).parents[1]\n\n"
        "def test_here():\n"
        "    assert Path(camwright.__file__).is_relative_to(HERE)\n"
        "    assert Path(camwright.design.__file__).is_relative_to(HERE)\n\n"
        "def test_processes_too(tmp_path):\n"
        "    code = 'import camwright; print(camwright.__file__)'\n"
        "    done = subprocess.run([sys.executable, '-c', code], cwd=tmp_path, capture_output=True, text=True, check=True)\n"
        "    assert Path(done.stdout.strip()).is_relative_to(HERE)\n",
        encoding="utf-8",
    )
    said = run([python, command, "-q", "-p", "no:cacheprovider", "tests/test_where.py"], cwd=linked)
    assert "2 passed" in said


def test_the_package_runs_as_a_module_under_its_own_name():
    said = subprocess.run(
        [sys.executable, "-m", "camwright", "--help"], capture_output=True, text=True, check=True
    ).stdout
    assert "Usage: camwright " in said
