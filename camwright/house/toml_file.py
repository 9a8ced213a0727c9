"""Reading TOML as people write it."""

from __future__ import annotations

import tomllib
from typing import Any

from camwright.house.toml_faults import toml_fault
from camwright.profiles.errors import InputError

MOST_BYTES = 1 << 20
"""The most bytes that a file of settings may have."""


def toml_data(text: str, place: str, what: str) -> dict[str, Any]:
    """Read what a TOML file holds.

    Parameters
    ----------
    text
        The file's text.
    place
        What messages begin with: the file's path.
    what
        What the file should be, e.g. ``"job file"``.

    Raises
    ------
    InputError
        It is not TOML.
    """
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError as error:
        raise InputError(f"{place}: not a {what}: its arrays or tables are nested too deeply") from error
    except ValueError as error:  # TOMLDecodeError, and integers beyond Python's limit of digits
        raise InputError(f"{place}: not TOML: {toml_fault(text, error)}") from error
