"""Replacing a folder as a whole: written aside, then renamed."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from camwright.profiles.errors import InputError


@contextlib.contextmanager
def replaced(directory: Path, ours: Callable[[Path], bool]) -> Iterator[Path]:
    """Give a folder to write into; at the end it takes the place of the directory, or nothing has changed.

    The folder lies beside the directory, on the same file system. What stands there already is replaced as a whole if it is ours
    or an empty directory; anything else is left alone.

    Parameters
    ----------
    directory
        Where the folder shall stand.
    ours
        Whether an existing directory may be replaced.

    Yields
    ------
    Path
        The folder aside.

    Raises
    ------
    InputError
        Something else is in the way, or the folder cannot be written.

    Examples
    --------
    >>> place = Path(tempfile.mkdtemp()) / "new"
    >>> with replaced(place, lambda old: False) as aside:
    ...     _ = (aside / "note.txt").write_text("done")
    >>> [file.name for file in place.iterdir()]
    ['note.txt']
    """
    target, aside = _prepared(directory, ours)
    try:
        new = aside / "new"
        new.mkdir()
        yield new
        _flush(new)
        _swap(new, target, aside / "old")
    except OSError as error:
        raise _refusal(directory, error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def require_replaceable(directory: Path, ours: Callable[[Path], bool]) -> None:
    """Refuse a directory that is not to be replaced, before the work that would fill it.

    Raises
    ------
    InputError
        Something else is there, or it cannot be looked at.
    """
    try:
        _require_free(directory, Path(os.path.abspath(directory)), ours)
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        raise _refusal(directory, error) from error


def _prepared(directory: Path, ours: Callable[[Path], bool]) -> tuple[Path, Path]:
    """Make sure that the directory may be replaced; where it is, and a new folder beside it."""
    try:
        target = Path(os.path.abspath(directory))  # ".." and "." have no name to rename to; links stay links
        _require_free(directory, target, ours)
        target.parent.mkdir(parents=True, exist_ok=True)
        return target, Path(tempfile.mkdtemp(prefix=".camwright-", dir=target.parent))
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        raise _refusal(directory, error) from error


def _refusal(directory: Path, error: OSError | ValueError) -> InputError:
    reason = error.strerror or str(error) if isinstance(error, OSError) else str(error)
    return InputError(
        f"{directory!s}: the folder cannot be written: {reason}; what was there is unchanged; choose another --out"
    )


def _require_free(directory: Path, target: Path, ours: Callable[[Path], bool]) -> None:
    if not os.path.lexists(target):
        return
    if target.is_symlink() or not target.is_dir() or (any(target.iterdir()) and not ours(target)):
        raise InputError(f"{directory}: something else is there, which is not overwritten; choose another --out")


def _flush(folder: Path) -> None:
    """Bring every file to the disk before its name stands for a finished one."""
    for file in sorted(folder.rglob("*")):
        if file.is_file():
            with file.open("rb") as stream:
                os.fsync(stream.fileno())


def _swap(new: Path, target: Path, old: Path) -> None:
    """Put the new folder where the old one stands; if that fails, the old one stands there again."""
    was_there = target.exists()
    if was_there:
        os.rename(target, old)
    try:
        os.rename(new, target)
    except OSError:
        if was_there:
            os.rename(old, target)
        raise
