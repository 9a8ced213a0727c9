"""Modules are called by the words of docs/words.md, and no two classes by one name."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CLASS = re.compile(r"^class (\w+)", re.MULTILINE)
KNOWN = set(re.findall(r"\*\*([a-z]+)\*\*", (ROOT / "docs" / "words.md").read_text(encoding="utf-8")))


def names() -> list[str]:
    """Give the names of all modules and rooms of the four packages, each once."""
    folders = [ROOT / folder for folder in ("camwright", "profiles", "design", "validation")]
    paths = [file.relative_to(ROOT) for folder in folders for file in folder.rglob("*.py")]
    return sorted({part.removesuffix(".py") for path in paths for part in path.parts} - {"__init__", "__main__"})


@pytest.mark.parametrize("name", names())
def test_a_module_is_called_by_words_of_the_list(name: str) -> None:
    unknown = [word for word in name.split("_") if word not in KNOWN]
    assert not unknown, f"{name}: {unknown} not in docs/words.md; use a word that stands there, or add yours"


def test_a_class_has_a_name_of_its_own() -> None:
    folders = [ROOT / folder for folder in ("camwright", "profiles", "design", "validation")]
    files = {file.resolve() for folder in folders for file in folder.rglob("*.py")}
    found = Counter(name for file in files for name in CLASS.findall(file.read_text(encoding="utf-8")))
    assert [name for name, times in found.items() if times > 1] == []
