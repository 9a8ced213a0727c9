"""A DXF file opened, repaired where it can be."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from camwright.bender.dxf_guard import look_at
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice

_SHOWN = 5


def open_dxf(path: Path) -> tuple[Any, tuple[str, ...]]:
    """Open a DXF file; a damaged one as far as it can be repaired.

    A number that cannot be read is not guessed.

    Returns
    -------
    (document, warnings)
        The ezdxf document, and what was repaired.

    Raises
    ------
    InputError
        The file is none, cut off, damaged beyond repair, or one of its numbers is.
    """
    look_at(path)
    import ezdxf
    from ezdxf import recover
    from ezdxf.audit import AuditError

    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)  # what it has to say is said below
    try:
        return ezdxf.readfile(path), ()  # type: ignore[attr-defined]
    except Exception as error:  # noqa: BLE001 - whatever the library makes of a damaged file
        first = str(error) or type(error).__name__
    try:
        document, audit = recover.readfile(path)
    except Exception as error:
        raise InputError(f"{path}: not a DXF file that can be read or repaired: {first[:200]}") from error
    entries = (*audit.errors, *audit.fixes)
    guessed = [entry for entry in entries if entry.code == AuditError.INVALID_FLOATING_POINT_VALUE]
    if guessed:
        raise InputError(
            f"{path}: {len(guessed)} numbers cannot be read ({first[:200]}), and a guessed coordinate is none; export the drawing again"
        )
    found = [entry.message for entry in entries]
    name = path.name
    damaged = "{file}: the file is damaged ({reason}) and was read as far as it could be repaired"
    warnings = [Notice(damaged, file=name, reason=first[:200])]
    warnings += [Notice("{file}: repaired: {repair}", file=name, repair=message) for message in found[:_SHOWN]]
    if len(found) > _SHOWN:
        warnings.append(Notice("{file}: {count} more repairs", file=name, count=str(len(found) - _SHOWN)))
    return document, tuple(warnings)


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Turn whatever the library makes of a damaged file into a refusal with its reason.

    Raises
    ------
    InputError
        Anything else was raised inside.
    """
    try:
        with np.errstate(all="ignore"):  # what is not finite is refused by name
            yield
    except InputError:
        raise
    except Exception as error:  # whatever the library makes of a damaged file
        reason = str(error) or type(error).__name__
        raise InputError(f"{path}: not a DXF file that can be read: {reason[:200]}") from error
