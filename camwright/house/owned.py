"""What of a folder is ours: a list beside the files says which of them a command wrote, so that a rerun replaces these and nothing else."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from camwright.house.files import Changes, fill, require_plain, staged
from camwright.house.progress import ignore
from camwright.profiles.errors import InputError

LIST = ".camwright.json"
"""Name of the list."""

_KIND = "camwright files"
_CHANGED = ".changed"
_MOST_BYTES = 16 * 2**20
_MOST_RIVALS = 2000
_DIGEST = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True)
class Work:
    """What a command makes files of.

    Parameters
    ----------
    command
        The command: ``"design"``.
    name
        Name of the job, or of the drawing.
    sha256
        SHA-256 of its text.
    source
        The file that it was read from, where the folder follows from the name alone: if a file beside it holds the work that
        would be replaced, two of one name have met. Nothing where the user named the folder.
    adds
        Whether files of earlier runs stay, as tables of several exports do.
    """

    command: str
    name: str
    sha256: str
    source: Path | None = None
    adds: bool = False


@dataclass(frozen=True)
class Owned:
    """Files of one work in a folder: SHA-256 by name."""

    command: str
    name: str
    sha256: str
    files: Mapping[str, str]

    def of(self, work: Work) -> bool:
        """Whether it is of this command and name, whatever the text was."""
        return (self.command, self.name) == (work.command, work.name)


@contextlib.contextmanager
def owned(
    directory: Path, work: Work, told: Callable[[str], None] = ignore, unlisted: Collection[str] = ()
) -> Iterator[Path]:
    """Give a folder to write files into like `staged`; files of an older run go, and all that is not ours stays.

    A file of ours that was changed since is kept under another name. A file of the same name that is not on the list is
    not overwritten.

    Parameters
    ----------
    directory
        Where the files shall stand.
    work
        What they are made of.
    told
        Told of what was replaced or kept and was not simply the same work before.
    unlisted
        Names of files that no later run may remove.

    Yields
    ------
    Path
        The folder aside.

    Raises
    ------
    InputError
        A file that is not ours is in the way; the folder holds the work of another job of this name; or as of `staged`.

    Examples
    --------
    >>> import tempfile
    >>> place, first = Path(tempfile.mkdtemp()), Work("design", "a job", "0" * 64)
    >>> with owned(place, first) as aside:
    ...     _ = (aside / "cam.csv").write_text("1"), (aside / "figure.svg").write_text("2")
    >>> _ = (place / "notes.txt").write_text("mine")
    >>> with owned(place, replace(first, sha256="1" * 64)) as aside:
    ...     _ = (aside / "cam.csv").write_text("3")
    >>> sorted(file.name for file in place.iterdir())
    ['.camwright.json', 'cam.csv', 'notes.txt']
    """
    notes: list[str] = []

    def settle(new: Path) -> Changes:
        return _settled(new, directory, work, frozenset(unlisted), notes)

    with staged(directory, settle) as aside:
        yield aside
    for note in notes:
        told(note)


def write_owned(
    directory: Path, work: Work, files: Mapping[str, str | bytes], told: Callable[[str], None] = ignore
) -> list[Path]:
    """Write files by name into a directory as `owned` has it; texts in UTF-8. Gives their paths."""
    with owned(directory, work, told) as aside:
        fill(aside, files)
    return [directory / name for name in files]


def _settled(new: Path, directory: Path, work: Work, unlisted: frozenset[str], notes: list[str]) -> Changes:
    """Find what becomes of the files that stand in the directory, write the new list, and note what people should know."""
    fresh = {file.name: _digest(file) for file in sorted(new.iterdir())}
    require_plain(directory, [*fresh, LIST])
    entries = read_list(directory)
    before = [entry for entry in entries if entry.of(work)]
    for entry in before:
        if entry.sha256 != work.sha256:
            require_no_rival(directory, entry.sha256, work)
    ours = {name: digest for entry in entries for name, digest in entry.files.items()}
    _require_ours(directory, {name: digest for name, digest in fresh.items() if name not in ours})
    stale = [] if work.adds else [name for entry in before for name in entry.files if name not in fresh]
    there = {
        name: _digest(directory / name) for name in (*fresh, *stale) if name in ours and _is_plain(directory / name)
    }
    changed = [name for name, digest in there.items() if digest not in (ours[name], fresh.get(name))]
    renamed = {
        name: free_name(name, lambda other: os.path.lexists(directory / other) or (new / other).exists())
        for name in changed
    }
    notes += [_replaced(directory, entry, work, fresh) for entry in entries if _is_news(entry, work, fresh)]
    notes += [f"{directory / name}: changed since camwright wrote it; kept as {kept}" for name, kept in renamed.items()]
    (new / LIST).write_text(_text(_listed(entries, work, fresh, unlisted)), encoding="utf-8")
    return Changes(tuple(name for name in stale if name in there and name not in renamed), renamed)


def _listed(entries: list[Owned], work: Work, fresh: Mapping[str, str], unlisted: frozenset[str]) -> list[Owned]:
    """Enter what was written; of the entries before, those of other works, and where a work adds to itself its own."""
    kept = [
        replace(entry, files={name: digest for name, digest in entry.files.items() if name not in fresh})
        for entry in entries
        if work.adds or not entry.of(work)
    ]
    same = [entry for entry in kept if entry.of(work) and entry.sha256 == work.sha256]
    own = {name: digest for entry in same for name, digest in entry.files.items()}
    own |= {name: digest for name, digest in fresh.items() if name not in unlisted}
    now = Owned(work.command, work.name, work.sha256, own)
    return [*(entry for entry in kept if entry.files and entry not in same), now]


def _is_news(entry: Owned, work: Work, fresh: Mapping[str, str]) -> bool:
    """Whether people should be told that files of an entry are replaced: they were made of something else."""
    if entry.of(work) and entry.sha256 == work.sha256:
        return False
    return not fresh.keys().isdisjoint(entry.files) or (entry.of(work) and not work.adds)


def _replaced(directory: Path, entry: Owned, work: Work, fresh: Mapping[str, str]) -> str:
    """Say what is replaced, and what stays though it is of something else."""
    state = "an earlier state of " if entry.of(work) else ""
    what = f"what {entry.command} made of {state}{entry.name!r} (SHA-256 {entry.sha256[:12]})"
    stay = sorted(entry.files.keys() - fresh.keys()) if work.adds or not entry.of(work) else []
    if not stay:
        return f"{directory}: {what} is replaced"
    return (
        f"{directory}: of {what} {_names(sorted(entry.files.keys() & fresh.keys()))} replaced, {', '.join(stay)} stay"
    )


def _names(names: list[str]) -> str:
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'}"


def read_list(directory: Path) -> list[Owned]:
    """Read the list of a folder; nothing where there is none.

    Raises
    ------
    InputError
        It is not the list that camwright writes: then nobody knows what is ours.
    """
    file = directory / LIST
    if not os.path.lexists(file):
        return []
    require_plain(directory, [LIST])
    try:
        with file.open("rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
        entries = _entries(json.loads(data.decode("utf-8")))
        if _text(entries).encode() != data:
            raise ValueError("its bytes are not those that were written")
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(
            f"{file}: this list of what camwright wrote is damaged, so nothing here is overwritten; move the folder away, or "
            "choose another --out"
        ) from error
    return entries


def _entries(data: dict[str, Any]) -> list[Owned]:
    """Read the entries; a name with a path in it, or a digest that is none, is no entry."""
    if data["kind"] != _KIND or data["schema_version"] != 1:
        raise ValueError("another kind of file")
    entries = [
        Owned(entry["command"], entry["name"], entry["sha256"], dict(entry["files"].items()))
        for entry in data["written"]
    ]
    for entry in entries:
        sound = all(
            name not in ("", ".", "..", LIST) and not re.search(r"[/\\\0]", name) and _DIGEST.fullmatch(digest)
            for name, digest in entry.files.items()
        )
        if not sound:
            raise ValueError("not a file of this folder")
    return entries


def _text(entries: list[Owned]) -> str:
    """Write the list the one way in which it is written."""
    ordered = sorted(entries, key=lambda entry: (entry.command, entry.name))
    written = [{**vars(entry), "files": dict(sorted(entry.files.items()))} for entry in ordered]
    return json.dumps({"kind": _KIND, "schema_version": 1, "written": written}, indent=1) + "\n"


def _require_ours(directory: Path, files: Mapping[str, str]) -> None:
    """Refuse to overwrite what is not on the list, unless it is the same bytes."""
    foreign = [
        name for name, digest in files.items() if _is_plain(directory / name) and _digest(directory / name) != digest
    ]
    if foreign:
        raise InputError(
            f"{directory}: {_names(foreign)} there already, and not on the list of "
            f"what camwright wrote ({LIST}); nothing was overwritten: move {'it' if len(foreign) == 1 else 'them'} away, or choose "
            "another --out"
        )


def require_no_rival(directory: Path, before: str, work: Work) -> None:
    """Refuse where the work that would be replaced, of this SHA-256, is of another file that still stands beside the one that was read.

    Raises
    ------
    InputError
        There are two jobs of one name.
    """
    if work.source is None:
        return
    folder, own = work.source.parent, work.source.name
    beside = (file for file in folder.glob(f"*{work.source.suffix}") if file.name != own and _is_plain(file))
    for file in sorted(beside)[:_MOST_RIVALS]:
        if file.stat().st_size <= _MOST_BYTES and _digest(file) == before:
            raise InputError(
                f"{directory}: holds the {work.command} of {file}, which is called {work.name!r} too; give one of them another name, "
                "or choose another --out"
            )


def free_name(name: str, taken: Callable[[str], bool]) -> str:
    """Give the first name for a changed file that no file has: nothing is lost."""
    stem, dot, ending = name.rpartition(".")
    head, tail = (stem, dot + ending) if stem else (name, "")
    wanted, number = f"{head}{_CHANGED}{tail}", 1
    while taken(wanted):
        number += 1
        wanted = f"{head}{_CHANGED}-{number}{tail}"
    return wanted


def _is_plain(place: Path) -> bool:
    return place.is_file() and not place.is_symlink()


def _digest(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
