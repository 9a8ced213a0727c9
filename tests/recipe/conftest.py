"""What the tests of recipes share: the paper's recipe, made once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from camwright import load_job
from camwright.recipes.build import MadeRecipe, designed, make_recipe
from camwright.recipes.write import recipe_files, write_folder
from camwright.stored.design_file import StoredDesign

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="session")
def paper_design() -> StoredDesign:
    return designed(load_job(EXAMPLES / "paper-600.toml"))


@pytest.fixture(scope="session")
def made(paper_design: StoredDesign) -> MadeRecipe:
    return make_recipe(paper_design, ["codesys", "logix", "csv"])


@pytest.fixture(scope="session")
def saw() -> MadeRecipe:
    """Give the recipe of a carriage with a mass, so with torques, for a target that joins points by straight lines."""
    return make_recipe(designed(load_job(EXAMPLES / "flying-saw.toml")), ["trio"], "de")


@pytest.fixture(scope="session")
def files(made: MadeRecipe) -> dict[str, bytes]:
    return recipe_files(made)


@pytest.fixture
def folder(files: dict[str, bytes], tmp_path: Path) -> Path:
    """Give a recipe folder of the test's own."""
    place = tmp_path / "recipe"
    write_folder(files, place)
    return place


@pytest.fixture
def paper_job() -> Path:
    return EXAMPLES / "paper-600.toml"


@pytest.fixture
def job_with(tmp_path: Path) -> Callable[..., Path]:
    """Write the paper's job with lines replaced, by the key that each begins with."""

    def write(**lines: str) -> Path:
        text = (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8").splitlines()
        for key, value in lines.items():
            places = [i for i, line in enumerate(text) if line.startswith(f"{key} = ")]
            assert len(places) == 1, key
            text[places[0]] = f"{key} = {value}"
        file = tmp_path / "changed.toml"
        file.write_text("\n".join(text) + "\n", encoding="utf-8")
        return file

    return write
