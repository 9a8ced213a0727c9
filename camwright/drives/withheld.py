"""Older tables of targets whose new table is withheld: set aside under another name, so that nobody loads them for new ones."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from camwright.house.owned import Work, owned
from camwright.profiles.errors import InputError
from camwright.profiles.tables.target import Header, Target

ENDING = ".withheld-old"
"""What the name of an older table ends with when its new version is withheld."""


def older_tables(directory: Path, targets: Sequence[Target], header: Header) -> dict[str, dict[str, str]]:
    """Find older tables of the same name, and the names that they are to have.

    Parameters
    ----------
    directory
        Where tables are written; it need not exist.
    targets
        Targets whose new table is withheld, or that cannot take the new cam.
    header
        Its name says how files are called.

    Returns
    -------
    dict
        For each target with older files: new names by old ones.
    """
    found = {}
    for target in targets:
        names = [name for name in target.file_names(header) if (directory / name).is_file()]
        if names:
            found[target.name] = {name: _free(directory, name) for name in names}
    return found


def _free(directory: Path, name: str) -> str:
    """Give the first name that no file has: nothing that was set aside before is lost."""
    wanted, number = name + ENDING, 1
    while (directory / wanted).exists():
        number += 1
        wanted = f"{name}{ENDING}-{number}"
    return wanted


@contextmanager
def setting_aside(
    directory: Path, work: Work, older: Mapping[str, Mapping[str, str]], told: Callable[[str], None]
) -> Iterator[Path]:
    """Give a folder to write files into like `owned`, in which older tables stand under their new names; they go from their old ones.

    Raises
    ------
    InputError
        A file cannot be removed; or as of `owned`.
    """
    renamed = {name: new for names in older.values() for name, new in names.items()}
    with owned(directory, work, told, renamed.values()) as aside:
        for name, new in renamed.items():
            shutil.copy2(directory / name, aside / new)
        yield aside
    for name, new in renamed.items():
        try:
            (directory / name).unlink(missing_ok=True)  # our own older table goes with the run that made it
        except OSError as error:
            raise InputError(
                f"{directory / name}: this older table cannot be removed: {error.strerror}; do not load it, its new "
                f"version is withheld (a copy is {new})"
            ) from error
