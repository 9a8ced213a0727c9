"""A first look at a DXF file before a library reads it: its size, its end, and how many entities it holds."""

from __future__ import annotations

import re
import stat
from pathlib import Path

from camwright.profiles.errors import InputError

MOST_BYTES = 64 * 1024**2
MOST_ENTITIES = 100_000
"""Entities, vertices of old polylines and block members included, above which a file is refused."""

_ENTITY = re.compile(rb"(?:^|\n)[ \t]*0[ \t]*\r?\n[ \t]*[A-Z]")
_END = re.compile(rb"(?:^|\n)[ \t]*0[ \t]*\r?\n[ \t]*EOF[ \t]*(?:\r?\n|\Z)")
_BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"


def look_at(path: Path) -> None:
    """Refuse a file that is none, too large, cut off, holds too many entities, or is no DXF.

    Raises
    ------
    InputError
        With the file's name and the reason.
    """
    try:
        about = path.stat()
        size = about.st_size
        if stat.S_ISDIR(about.st_mode):
            raise InputError(f"{path}: a directory, not a drawing; name a DXF file in it")
        if not stat.S_ISREG(about.st_mode):
            raise InputError(f"{path}: a device or a pipe, not a drawing; name a DXF file")
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
        # the code 0 ahead of an entity's name has two bytes, one in the oldest files
        code = rb"\x00\x00" if data.startswith(b"\x00\x00", len(_BINARY)) else rb"\x00"
        entity, end = re.compile(code + rb"[A-Z][A-Z0-9_]{2,}\x00"), re.compile(code + rb"EOF(?:\x00|\Z)")
    elif re.match(rb"(?:\xef\xbb\xbf)?\s*(?:999\r?\n[^\n]*\n\s*)*0\s*\r?\n\s*SECTION", data):
        entity, end = _ENTITY, _END
    else:
        raise InputError(f"{path}: not a DXF file: it does not begin with a section")
    for count, _ in enumerate(entity.finditer(data)):
        if count == MOST_ENTITIES:
            raise InputError(
                f"{path}: more than {MOST_ENTITIES} entities; keep the die lines only, as LWPOLYLINE, and purge "
                "the rest"
            )
    if not end.search(data):
        raise InputError(
            f"{path}: not a DXF file to its end: it breaks off without EOF; export or copy the drawing again"
        )
