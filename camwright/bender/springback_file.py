"""Springback tables as TOML files: bundled ones by name, others by path."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from camwright.bender.structure import SpringbackFile
from camwright.house.files import read_text
from camwright.house.setting_fields import Settings
from camwright.house.settings import read_settings
from camwright.house.toml_file import MOST_BYTES, toml_data
from camwright.profiles.bender.springback import Interpolation, Springback
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
    data = toml_data(read_text(path, "springback table", MOST_BYTES), str(path), "springback table")
    file, faults = read_settings(SpringbackFile, data, Settings())
    if file is None:
        raise InputError(*(f"{path}: {fault}" for fault in faults))
    found = next(
        (
            rule
            for rule in file.rule
            if math.isclose(rule.thickness, thickness, rel_tol=1e-9) and rule.hardness == hardness
        ),
        None,
    )
    if found is None:
        raise InputError(
            f"{path}: no table for a rule of {1e3 * thickness:g} mm, hardness {hardness!r}; the file has "
            f"{', '.join(f'{1e3 * rule.thickness:g} mm {rule.hardness}' for rule in file.rule)}; "
            "choose another rule, or measure this one: camwright bend --calibrate"
        )
    angles, radii = np.array(found.angles).reshape(-1, 2), np.array(found.radii).reshape(-1, 2)
    return Springback(file.name, angles[:, 0], angles[:, 1], radii[:, 0], radii[:, 1], found.radius_step, interpolation)
