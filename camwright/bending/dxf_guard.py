"""A first look at a DXF file before a library reads it: its size, and how many entities it holds."""

from __future__ import annotations

import re
from pathlib import Path

from profiles.errors import InputError

MOST_BYTES = 256 * 1024**2
MOST_ENTITIES = 100_000
"""Entities, vertices of old polylines and block members included, above which a file is refused."""

_ENTITY = re.compile(rb"(?:^|\n)[ \t]*0[ \t]*\r?\n[ \t]*[A-Z]")
_BINARY = b"AutoCAD Binary DXF"


def look_at(path: Path) -> None:
    """Refuse a file that is none, too large, holds too many entities, or is no DXF.

    Raises
    ------
    InputError
        With the file's name and the reason.
    """
    try:
        size = path.stat().st_size
        if path.is_dir():
            raise InputError(f"{path}: a directory, not a drawing; name a DXF file in it")
        if size > MOST_BYTES:
            raise InputError(f"{path}: {size} bytes, more than the {MOST_BYTES} of the largest drawing that is read")
        with path.open("rb") as file:
            _scan(path, file.read())
    except FileNotFoundError as error:
        raise InputError(f"{path}: there is no such drawing") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: the drawing cannot be read: {error}") from error


def _scan(path: Path, data: bytes) -> None:
    if not data.strip():
        raise InputError(f"{path}: the drawing is empty, 0 entities")
    if data.startswith(_BINARY):
        return
    if not re.match(rb"(?:\xef\xbb\xbf)?\s*(?:999\r?\n[^\n]*\n\s*)*0\s*\r?\n\s*SECTION", data):
        raise InputError(f"{path}: not a DXF file: it does not begin with a section")
    for count, _ in enumerate(_ENTITY.finditer(data)):
        if count == MOST_ENTITIES:
            raise InputError(
                f"{path}: more than {MOST_ENTITIES} entities; keep the die lines only, as LWPOLYLINE, and purge "
                "the rest"
            )
