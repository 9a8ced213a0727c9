"""Makes the pictures of README and gallery anew: ``python docs/pictures.py``. The recipe's page is drawn by poppler's ``pdftoppm``."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from camwright import baseline, load_job
from camwright.cli.main import main

HERE = Path(__file__).parent
FIGURES = HERE / "figures"
EXAMPLES = HERE.parent / "examples"

PICTURES = {
    "paper-600": ("profile", "servo", "comparison"),
    "cross-cutter": ("profile",),
    "flying-saw": ("profile",),
    "chasing-shear": ("profile", "crank"),
    "thick-product": ("profile",),
    "cross-sealer": ("profile",),
    "flying-punch": ("profile",),
}
"""Figures of each example that the documents show; those of the paper's job bear no prefix."""


def run(*arguments: str | Path) -> None:
    """Run a command; a failed check is no reason to stop."""
    if main([str(argument) for argument in arguments]) > 1:
        raise SystemExit(f"camwright {arguments[0]} failed")


def designs(place: Path) -> None:
    """Draw the designs."""
    for example, figures in PICTURES.items():
        run("design", EXAMPLES / f"{example}.toml", "--out", place / example, "--quiet")
        for figure in figures:
            name = figure if example == "paper-600" else f"{example}-{figure}"
            shutil.copyfile(place / example / f"{figure}.png", FIGURES / f"{name}.png")


def audit(place: Path) -> None:
    """Draw the audit of a quintic cam as 361 points of a spreadsheet."""
    job = load_job(EXAMPLES / "paper-600.toml")
    cam = baseline("poly_3_4_5", job.task)
    x = np.linspace(0.0, job.cut.length, 361)
    rows = [f"{1e3 * a:.6f},{1e3 * b:.9f}" for a, b in zip(x, cam(x), strict=True)]
    table = place / "running.csv"
    table.write_text("\n".join(["x [mm],y [mm]", *rows]) + "\n", encoding="utf-8")
    run("audit", table, "--job", EXAMPLES / "paper-600.toml", "--out", place / "audit", "--quiet")
    shutil.copyfile(place / "audit" / "audit.png", FIGURES / "audit.png")


def recipe(place: Path) -> None:
    """Draw the first page of a recipe."""
    run("recipe", EXAMPLES / "paper-600.toml", "--targets", "codesys,logix", "--out", place / "recipe", "--quiet")
    command = ["pdftoppm", "-png", "-r", "90", "-singlefile", "-l", "1", str(place / "recipe" / "recipe.pdf")]
    subprocess.run([*command, str(FIGURES / "recipe-page")], check=True)


def production(place: Path) -> None:
    """Draw the plan of a cut list, and a shift."""
    order, shift = place / "order.csv", place / "shift.csv"
    order.write_text("length [mm],quantity\n600,3\n300,3\n600,3\n", encoding="utf-8")
    shift.write_text("length [mm],quantity\n600,600\n300,200\n450,200\n", encoding="utf-8")
    job, ramp = EXAMPLES / "paper-600.toml", ("--line-acceleration", "0.2 m/s^2")
    run("cutlist", job, order, "--line-acceleration", "1 m/s^2", "--out", place / "list", "--quiet")
    wrong = ("--noise", "2 um", "--slip", "0.0002", "--marks", "0.3 mm", "--seed", "7")
    run("simulate", job, "--list", shift, *ramp, *wrong, "--out", place / "shift", "--quiet")
    shutil.copyfile(place / "list" / "line-plan.png", FIGURES / "line-plan.png")
    shutil.copyfile(place / "shift" / "shift.png", FIGURES / "shift.png")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        for draw in (designs, audit, recipe, production):
            draw(Path(folder))
