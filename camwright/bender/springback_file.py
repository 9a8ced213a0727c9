"""Springback tables as TOML files: bundled ones by name, others by path."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from camwright.bender.toml_table import TomlTable, read_toml
from camwright.profiles.bender.springback import PAPER_STEP, Interpolation, Springback
from camwright.profiles.errors import InputError

BUNDLED = Path(__file__).parent / "tables"
"""Where the bundled tables lie."""

EXAMPLE = "example"
"""The bundled table that is not measured on any rule."""


def find_table(name: str, beside: Path) -> Path:
    """Find a table: a bundled one by its name, another by its path from the job file's directory."""
    bundled = BUNDLED / f"{name}.toml"
    return bundled if "/" not in name and bundled.is_file() else beside / name


def load_springback(path: Path, thickness: float, hardness: str, interpolation: Interpolation) -> Springback:
    """Read the table of one rule from a file.

    Parameters
    ----------
    path
        The file; it may hold tables of several rules.
    thickness
        Thickness of the rule (m).
    hardness
        Its hardness, in the words of the file.
    interpolation
        ``"linear"`` or ``"cubic"``.

    Raises
    ------
    InputError
        The file has faults, has no table for the rule, or its table cannot be used.
    """
    data, _ = read_toml(path, "springback table")
    faults: list[str] = []
    file = TomlTable(data, str(path), faults)
    name = file.text("name")
    found, known = None, []
    for rule in file.tables("rule"):
        this = (rule.quantity("thickness", "length"), rule.text("hardness"))
        angles = np.array(rule.rows("angles", ("angle", "angle"))).reshape(-1, 2)
        step = rule.quantity("radius_step", "angle", default=PAPER_STEP)
        radii = np.array(rule.rows("radii", ("length", "angle"), needed=False)).reshape(-1, 2)
        rule.close()
        known.append(f"{1e3 * this[0]:g} mm {this[1]}")
        if math.isclose(this[0], thickness, rel_tol=1e-9) and this[1] == hardness:
            found = (angles, radii, step)
    file.close()
    if faults:
        raise InputError(*faults)
    if found is None:
        raise InputError(
            f"{path}: no table for a rule of {1e3 * thickness:g} mm, hardness {hardness!r}; the file has "
            f"{', '.join(known)}; "
            "choose another rule, or measure this one: camwright bend --calibrate"
        )
    angles, radii, step = found
    return Springback(name, angles[:, 0], angles[:, 1], radii[:, 0], radii[:, 1], step, interpolation)
