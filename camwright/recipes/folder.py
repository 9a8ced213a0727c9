"""A folder as it is found, against its manifest: every file, and whether it is the one that was written."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from camwright.profiles.errors import InputError
from camwright.recipes.manifest import MANIFEST_FILE, read_manifest, sha256
from camwright.recipes.table_faults import Fault
from camwright.stored.design_file import MOST_BYTES

_OF_THE_SYSTEM = ("thumbs.db", "ehthumbs.db", ".ds_store", "desktop.ini")
"""Files that a desktop puts into folders by itself, by their names in small letters."""


def contents(directory: Path) -> tuple[dict[str, bytes | None], list[Fault]]:
    """Read all files of a folder.

    Returns
    -------
    (data, notes)
        Contents by path, nothing for what cannot be read; notes of what the desktop put there, which is left out.

    Raises
    ------
    InputError
        There is no such folder.
    """
    data = {path: _bytes(directory / path) for path in sorted(_files(directory))}
    notes = [
        Fault(path, "put there by the desktop; no part of what was written")
        for path in data
        if Path(path).name.lower() in _OF_THE_SYSTEM and data[path] is not None
    ]
    for note in notes:
        del data[note.file]
    return data, notes


def _files(directory: Path) -> set[str]:
    """Paths of everything in a folder that is not a plain directory."""
    if not directory.is_dir():
        raise InputError(f"{directory}: there is no such directory")
    paths = set()
    for root, folders, names in os.walk(directory):
        links = [name for name in folders if (Path(root) / name).is_symlink()]
        paths |= {(Path(root) / name).relative_to(directory).as_posix() for name in (*names, *links)}
    return paths


def _bytes(file: Path) -> bytes | None:
    """Contents of a file; nothing for what is no plain file, too large, or cannot be read."""
    if file.is_symlink() or not file.is_file():
        return None
    try:
        return file.read_bytes() if file.stat().st_size <= MOST_BYTES else None
    except OSError:
        return None


def sum_faults(data: dict[str, bytes | None]) -> Iterator[Fault]:
    """Compare the folder with its manifest."""
    manifest = data.get(MANIFEST_FILE)
    if manifest is None:
        yield Fault(MANIFEST_FILE, "missing, or not a readable file")
        return
    stored, faults = read_manifest(manifest)
    for fault in faults:
        yield Fault(MANIFEST_FILE, fault)
    for path in sorted(stored.keys() | data.keys() - {MANIFEST_FILE}):
        content = data.get(path)
        if path not in stored:
            yield Fault(path, "not in the manifest")
        elif path not in data:
            yield Fault(path, "missing")
        elif content is None:
            yield Fault(path, "not a readable file")
        elif (found := sha256(content)) != stored[path][0]:
            yield Fault(path, f"SHA-256 is {found}, the manifest has {stored[path][0]}")
        elif len(content) != stored[path][1]:
            yield Fault(path, f"{len(content)} bytes, the manifest has {stored[path][1]}")
