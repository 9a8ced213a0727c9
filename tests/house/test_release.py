"""What a release says of itself agrees, wherever it is said."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_version_is_the_same_everywhere() -> None:
    version = PROJECT["version"]
    assert re.search(
        rf"^version: {re.escape(version)}$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE
    )
    sections = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert sections[:2] == ["Unreleased", version]


def test_the_licence_is_the_same_everywhere() -> None:
    assert f"license: {PROJECT['license']}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_python_versions_are_claimed_from_the_least_that_is_taken() -> None:
    """Each version that is claimed is one that the suite was run on; see CONTRIBUTING.md."""
    least = PROJECT["requires-python"].removeprefix(">=")
    claimed = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"]))
    assert claimed[0] == least
