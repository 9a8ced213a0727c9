"""Reading files within bounds, and writing files so that nothing half-written is left anywhere."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from camwright.profiles.errors import InputError


def read_text(path: Path, what: str, limit: int) -> str:
    """Read a text file in UTF-8.

    Parameters
    ----------
    path
        The file.
    what
        What messages call it, e.g. ``"job file"``.
    limit
        The most bytes that are read.

    Raises
    ------
    InputError
        It is missing, a directory, unreadable, larger than the limit, empty, or not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(limit + 1)
    except FileNotFoundError as error:
        raise InputError(f"{path}: there is no such {what}") from error
    except IsADirectoryError as error:
        raise InputError(f"{path}: a directory, not a {what}; name a file in it") from error
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        raise InputError(f"{path!s}: the {what} cannot be read: {_reason(error)}") from error
    if len(data) > limit:
        raise InputError(f"{path}: larger than {limit} bytes, the most that a {what} may have")
    if not data.strip():
        raise InputError(f"{path}: the {what} is empty")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start}); save the {what} as UTF-8") from error


@contextlib.contextmanager
def staged(directory: Path) -> Iterator[Path]:
    """Give a folder to write files into; at the end they are all moved into the directory, or none of them.

    The folder lies inside the directory, which is made when it is missing. When anything fails, the folder, what was
    moved already and the directories made here are taken back; files that were there before are put back.

    Parameters
    ----------
    directory
        Where the files shall stand.

    Yields
    ------
    Path
        The folder aside.

    Raises
    ------
    InputError
        The directory cannot be made, or a file cannot be written or moved.

    Examples
    --------
    >>> import tempfile
    >>> place = Path(tempfile.mkdtemp()) / "new"
    >>> with staged(place) as aside:
    ...     _ = (aside / "note.txt").write_text("done")
    >>> [file.name for file in place.iterdir()]
    ['note.txt']
    """
    made = _make(directory)
    aside: Path | None = None
    try:
        aside = Path(tempfile.mkdtemp(prefix=".camwright-", dir=directory))
        new = aside / "new"
        new.mkdir()
        yield new
        _move_all(new, directory, aside / "old")
    except OSError as error:
        _take_back(aside, made)
        raise InputError(
            f"{directory}: the files cannot be written: {_reason(error)}; nothing was left there; choose another --out"
        ) from error
    except BaseException:
        _take_back(aside, made)
        raise
    shutil.rmtree(aside)


def _make(directory: Path) -> list[Path]:
    """Make a directory and the missing ones above it; those that were made, the outermost first."""
    made: list[Path] = []
    try:
        missing = [place for place in (directory, *directory.parents) if not place.exists()]
        for place in reversed(missing):
            place.mkdir()
            made.append(place)
        if not directory.is_dir():
            raise NotADirectoryError(20, "a file is in the way")
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        _take_back(None, made)
        raise InputError(
            f"{directory!s}: the output directory cannot be made: {_reason(error)}; choose another --out"
        ) from error
    return made


def _move_all(new: Path, directory: Path, old: Path) -> None:
    """Flush every file to the disk and move it into the directory; on failure put everything back."""
    names = sorted(file.name for file in new.iterdir())
    for name in names:
        with (new / name).open("rb") as file:
            os.fsync(file.fileno())
        if (directory / name).is_dir():
            raise IsADirectoryError(21, f"a directory is in the way of the file {name}")
    old.mkdir()
    moved: list[str] = []
    try:
        for name in names:
            if os.path.lexists(directory / name):
                shutil.copy2(directory / name, old / name, follow_symlinks=False)
            os.replace(new / name, directory / name)
            moved.append(name)
    except BaseException:
        for name in moved:
            if os.path.lexists(old / name):
                os.replace(old / name, directory / name)
            else:
                (directory / name).unlink()
        raise


def _take_back(aside: Path | None, made: list[Path]) -> None:
    """Remove the folder aside and the directories that were made."""
    if aside is not None:
        shutil.rmtree(aside, ignore_errors=True)
    for place in reversed(made):
        with contextlib.suppress(OSError):  # someone else wrote into it meanwhile: theirs to keep
            place.rmdir()


def _reason(error: OSError | ValueError) -> str:
    """Say why an operation on a file failed, in the system's words."""
    return error.strerror or str(error) if isinstance(error, OSError) else str(error)
