"""Reading files within bounds, and writing files so that nothing half-written is left anywhere."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from camwright.profiles.errors import InputError

_MANY = 100
"""Files from which on the whole disk is synchronised at once: one by one, ten thousand take a minute."""

_WAIT = 30.0
"""Seconds that a command waits for another one to have moved its files."""

_DEVICES = re.compile(r"(?i)(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[0-9¹²³])( *\.|:|$)")


def is_device_name(name: str) -> bool:
    """Whether Windows takes a name of a file or folder for a device, as it takes ``con`` and ``aux.csv``.

    Examples
    --------
    >>> [name for name in ("con", "Aux.csv", "com1", "LPT¹.txt", "nul .txt", "control", "com10", "a.con") if is_device_name(name)]
    ['con', 'Aux.csv', 'com1', 'LPT¹.txt', 'nul .txt']
    """
    return _DEVICES.match(name) is not None


def read_bytes(path: Path, what: str, limit: int) -> bytes:
    """Read a file.

    Parameters
    ----------
    what
        What messages call it, e.g. ``"job file"``.
    limit
        The most bytes that are read.

    Raises
    ------
    InputError
        It is missing, a directory, unreadable, larger than the limit, or empty.
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
    return data


def read_text(path: Path, what: str, limit: int) -> str:
    """Read a text file in UTF-8, else like `read_bytes`.

    Raises
    ------
    InputError
        As of `read_bytes`, or it is not UTF-8.
    """
    data = read_bytes(path, what, limit)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start}); save the {what} as UTF-8") from error


@dataclass(frozen=True)
class Changes:
    """What else happens to a directory when files are moved into it.

    Parameters
    ----------
    gone
        Names of files that are removed.
    renamed
        New names of files that are kept under another one, by their old ones.
    """

    gone: tuple[str, ...] = ()
    renamed: Mapping[str, str] = field(default_factory=dict)


@contextlib.contextmanager
def staged(directory: Path, settle: Callable[[Path], Changes] = lambda _: Changes()) -> Iterator[Path]:
    """Give a folder to write files into; at the end they are all moved into the directory, or none of them.

    The folder lies inside the directory, which is made when it is missing. When anything fails, the folder, what was
    moved already and the directories made here are taken back; files that were there before are put back. Where a link, a device
    or a directory has the name of a file, nothing is written.

    Parameters
    ----------
    directory
        Where the files shall stand.
    settle
        Asked when the folder is full: looks at it, may add to it, and says what else shall happen.

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
        with _alone(directory, directory / ".camwright-moving"):
            _move_all(new, directory, aside / "old", settle(new))
    except OSError as error:
        _take_back(aside, made)
        raise InputError(
            f"{directory}: the files cannot be written: {_reason(error)}; what was there is as it was; choose another --out"
        ) from error
    except BaseException:
        _take_back(aside, made)
        raise
    shutil.rmtree(aside)


def write_files(directory: Path, files: Mapping[str, str | bytes]) -> list[Path]:
    """Write files by name into a directory, all or none as `staged` has it; texts in UTF-8. Gives their paths."""
    with staged(directory) as aside:
        fill(aside, files)
    return [directory / name for name in sorted(files)]


def fill(folder: Path, files: Mapping[str, str | bytes]) -> None:
    """Write files by name into a folder that lies aside; texts in UTF-8."""
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def flush(place: Path) -> None:
    """Bring a file, or every file of a folder, to the disk before its name stands for a finished one."""
    files = [file for file in sorted(place.rglob("*")) if file.is_file()] if place.is_dir() else [place]
    if len(files) > _MANY and hasattr(os, "sync"):
        os.sync()
        return
    for file in files:
        with file.open("rb") as stream:
            os.fsync(stream.fileno())


def put(new: Path, target: Path) -> None:
    """Move what was written aside, on the same file system, to where it shall stand; a file there is replaced, a folder removed before."""
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.is_dir() and not target.is_symlink():
        shutil.rmtree(target)
    os.replace(new, target)


@contextlib.contextmanager
def replaced(
    directory: Path, ours: Callable[[Path], bool], theirs: Callable[[Path], Mapping[str, str]] = lambda _: {}
) -> Iterator[Path]:
    """Give a folder to write into; at the end it takes the place of the directory, or nothing has changed.

    The folder lies beside the directory, on the same file system. What stands there already is replaced as a whole if it is ours
    or an empty directory; anything else is left alone.

    Parameters
    ----------
    directory
        Where the folder shall stand.
    ours
        Whether an existing directory may be replaced.
    theirs
        Paths of the files in such a directory that are to stay, and the paths that they get in the new one.

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
    >>> import tempfile
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
        with _alone(directory, target.with_name(f".camwright-moving-{target.name}")):
            _require_free(directory, target, ours)
            if target.exists():
                _carry(target, new, theirs(target))
            flush(new)
            _swap(new, target, aside / "old")
    except OSError as error:
        raise _refusal(directory, error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)


@contextlib.contextmanager
def _alone(directory: Path, sign: Path) -> Iterator[None]:
    """Move files while no other command does so in the same place: who comes second finds all that the first one left.

    The sign is a directory, which only one can make on any file system, a shared drive too.
    """
    end = time.monotonic() + _WAIT
    while True:
        try:
            sign.mkdir()
            break
        except FileExistsError as error:
            if time.monotonic() > end:
                raise InputError(
                    f"{directory}: another camwright is moving its files here, or was killed while it did; nothing was written: "
                    f"where none is at work, remove {sign} and run this again, or choose another --out"
                ) from error
            time.sleep(0.01)
    try:
        yield
    finally:
        sign.rmdir()


def _carry(old: Path, new: Path, theirs: Mapping[str, str]) -> None:
    """Copy files that are to stay; one that would be written over one of the new ones is in the way."""
    for path, kept in theirs.items():
        if os.path.lexists(new / kept) or (not (old / path).is_symlink() and not (old / path).is_file()):
            raise InputError(
                f"{old / path}: not written by camwright, and in the way; nothing was changed: move it away, or choose another --out"
            )
        (new / kept).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(old / path, new / kept, follow_symlinks=False)


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
    return InputError(
        f"{directory!s}: the folder cannot be written: {_reason(error)}; what was there is unchanged; choose another --out"
    )


def _require_free(directory: Path, target: Path, ours: Callable[[Path], bool]) -> None:
    if not os.path.lexists(target):
        return
    if target.is_symlink() or not target.is_dir() or (any(target.iterdir()) and not ours(target)):
        raise InputError(f"{directory}: something else is there, which is not overwritten; choose another --out")


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


def _make(directory: Path) -> list[Path]:
    """Make a directory and the missing ones above it; those that were made, the outermost first."""
    made: list[Path] = []
    try:
        missing = [place for place in (directory, *directory.parents) if not place.exists()]
        for place in reversed(missing):
            with contextlib.suppress(FileExistsError):  # another command made it at the same moment
                place.mkdir()
                made.append(place)
        if not directory.is_dir():
            raise NotADirectoryError(20, _IN_THE_WAY)
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        _take_back(None, made)
        raise _not_made(directory, error) from error
    return made


def require_no_file(directory: Path) -> None:
    """Refuse a directory in whose place, or above it, a file stands: before work that takes long.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        there = next((place for place in (directory, *directory.parents) if place.exists()), None)
        if there is not None and not there.is_dir():
            raise NotADirectoryError(20, _IN_THE_WAY)
    except (OSError, ValueError) as error:
        raise _not_made(directory, error) from error


def _not_made(directory: Path, error: OSError | ValueError) -> InputError:
    """Say why a directory cannot be made."""
    return InputError(f"{directory!s}: the output directory cannot be made: {_reason(error)}; choose another --out")


_IN_THE_WAY = "a file is in the way"


def _move_all(new: Path, directory: Path, old: Path, changes: Changes) -> None:
    """Flush every file to the disk and move it into the directory; on failure put everything back."""
    names = sorted(file.name for file in new.iterdir())
    require_plain(directory, names)
    flush(new)
    old.mkdir()
    added: list[str] = []
    try:
        for name in sorted({*names, *changes.gone, *changes.renamed}):
            if os.path.lexists(directory / name):
                shutil.copy2(directory / name, old / name, follow_symlinks=False)
        for name, kept in changes.renamed.items():
            os.rename(directory / name, directory / kept)
            added.append(kept)
        for name in names:
            os.replace(new / name, directory / name)
            added.append(name)
        for name in changes.gone:
            (directory / name).unlink()
    except BaseException:
        for name in added:
            (directory / name).unlink()
        for kept_copy in old.iterdir():
            os.replace(kept_copy, directory / kept_copy.name)
        raise


def require_plain(directory: Path, names: Iterable[str]) -> None:
    """Refuse to put files where something stands that is no plain file.

    Raises
    ------
    InputError
        A directory, a link or a device has one of the names.
    """
    for name in names:
        place = directory / name
        if os.path.lexists(place) and not stat.S_ISREG(place.lstat().st_mode):
            raise InputError(
                f"{place}: {_kind_of(place)} is in the way of the file {name} and is left alone; move it away, or choose another --out"
            )


def _kind_of(place: Path) -> str:
    if place.is_symlink():
        return "a link"
    return "a directory" if place.is_dir() else "a device"


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
