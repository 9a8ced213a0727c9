"""What each call of the page asks of the command line."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from camwright.house.language import LANGUAGES, Language
from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, target_of
from camwright.workbench.runner import JOB_FILE

_OUT = ("--out", "out")

_DESIGN = "design.json"

_DROPPED, _NAMELESS = "dropped", "file"
"""Folder of files that were dropped on the page, and what one without a name is called."""

_TEXTS = {
    "toml": "the text of a job file",
    "design": "the text of a design.json",
    "units": "units of master and slave",
}
"""What the texts of calls are."""

_LONGEST = 60
"""Signs of a file's name that are kept, from its end."""


@dataclass(frozen=True)
class PageCall:
    """Commands to run, and the files that they need.

    Parameters
    ----------
    commands
        Arguments of each.
    inputs
        Files by name.
    """

    commands: tuple[tuple[str, ...], ...]
    inputs: dict[str, bytes]


def call_of(name: str, body: dict[str, Any]) -> PageCall:
    """Make the call of a name from what the page sends.

    Raises
    ------
    InputError
        Something that it needs is missing, or not what it should be.
    """
    return _CALLS[name](body)


def job_text(body: dict[str, Any]) -> str:
    """Take the job from what the page sends."""
    return text_of(body, "toml")


def text_of(body: dict[str, Any], key: str) -> str:
    """Take a text from what the page sends."""
    text = body.get(key)
    if not isinstance(text, str):
        raise InputError(f'the body has no "{key}", {_TEXTS[key]}')
    if any("\ud800" <= sign <= "\udfff" for sign in text):
        raise InputError(f'"{key}" holds half a sign (a lone surrogate); send whole ones')
    return text


def laws_of(body: dict[str, Any]) -> list[str]:
    """Take the names of baselines to draw from what the page sends."""
    laws = body.get("laws", [])
    if not isinstance(laws, list) or not all(isinstance(law, str) for law in laws):
        raise InputError('"laws" is a list of names of baselines')
    return laws


def file_of(body: dict[str, Any]) -> tuple[str, bytes]:
    """Take a file that was dropped on the page: its name without any folder, and its bytes.

    Only letters, digits and plain signs of the name are kept: it becomes the name of a file, and of programs made from it.
    """
    name, data = body.get("name"), body.get("base64")
    if not isinstance(name, str) or not isinstance(data, str):
        raise InputError('a file is sent as its "name" and its bytes as "base64"')
    plain = re.sub(r"[^A-Za-z0-9_. -]", "_", re.split(r"[/\\]", name)[-1])[-_LONGEST:].lstrip("-. ")
    try:
        return plain or _NAMELESS, base64.b64decode(data, validate=True)
    except binascii.Error as error:
        raise InputError('"base64" is no base64') from error


def _job(body: dict[str, Any]) -> dict[str, bytes]:
    """Give the job as the input of a command."""
    return {JOB_FILE: job_text(body).encode()}


def _check(body: dict[str, Any]) -> PageCall:
    return PageCall((("check", JOB_FILE, "--json"),), _job(body))


def _design(body: dict[str, Any]) -> PageCall:
    figures = () if flag_of(body, "figures") else ("--no-figures",)
    brief = ("--brief",) if flag_of(body, "brief") else ()
    return PageCall((("design", JOB_FILE, "--json", *figures, *brief, *_OUT),), _job(body))


def _compare(body: dict[str, Any]) -> PageCall:
    objectives = ("--objectives",) if flag_of(body, "objectives") else ()
    return PageCall((("compare", JOB_FILE, "--json", "--no-figures", *objectives),), _job(body))


def _limits(body: dict[str, Any]) -> PageCall:
    return PageCall((("limits", JOB_FILE, "--json"),), _job(body))


def _envelope(body: dict[str, Any]) -> PageCall:
    points = body.get("points", 9)
    if not isinstance(points, int) or isinstance(points, bool) or not 2 <= points <= 40:
        raise InputError(f'"points" is {points!r}; it is a whole number from 2 to 40')
    command = ("envelope", JOB_FILE, "--json", "--no-figures", "--points", str(points), *_OUT)
    return PageCall((command,), _job(body))


def _export(body: dict[str, Any]) -> PageCall:
    design = ("design", JOB_FILE, "--json", "--brief", *_OUT)
    units = ("--units", _plain(body, "units")) if body.get("units") else ()
    tables = ("export", "out/design.json", "--to", _targets(body), *units, "--out", "tables", "--json")
    return PageCall((design, tables), _job(body))


def _recipe(body: dict[str, Any]) -> PageCall:
    command = ("recipe", JOB_FILE, "--targets", _targets(body), "--language", language_of(body), "--out", "recipe")
    return PageCall(((*command, "--json"),), _job(body))


def language_of(body: Mapping[str, Any]) -> Language:
    """Take the language from what the page sends; English if it is left out."""
    language = body.get("language", "en")
    for known in LANGUAGES:
        if language == known:
            return known
    raise InputError(f'"language" is {language!r}; it is {", ".join(LANGUAGES)}')


def _audit(body: dict[str, Any]) -> PageCall:
    """Judge a table that was dropped on the page."""
    name, data = file_of(body)
    units = ("--units", _plain(body, "units")) if body.get("units") else ()
    path = f"{_DROPPED}/{name}"
    return PageCall((("audit", path, "--job", JOB_FILE, "--json", "--no-figures", *units),), _job(body) | {path: data})


def _identify(body: dict[str, Any]) -> PageCall:
    """Find the servo of a recording that was dropped on the page."""
    name, data = file_of(body)
    path = f"{_DROPPED}/{name}"
    return PageCall((("identify", path, "--json", "--out", "servo.toml"),), {path: data})


def _trace(body: dict[str, Any]) -> PageCall:
    """Lay a recording over a design: the sync error of each cut."""
    name, data = file_of(body)
    path, design = f"{_DROPPED}/{name}", text_of(body, "design").encode()
    command = ("trace", path, "--job", JOB_FILE, "--design", _DESIGN, "--json", "--no-figures")
    return PageCall((command,), _job(body) | {path: data, _DESIGN: design})


def _bend(body: dict[str, Any]) -> PageCall:
    """Bend a drawing that was dropped on the page; the bundled bender if no job of one is sent."""
    name, data = file_of(body)
    path = f"{_DROPPED}/{name}"
    bender = ("--job", JOB_FILE) if "toml" in body else ()
    reverse = ("--reverse",) if flag_of(body, "reverse") else ()
    accept = ("--accept-collisions",) if flag_of(body, "accept_collisions") else ()
    spoken = ("--language", language_of(body))
    command = ("bend", path, *bender, "--styles", "all", *reverse, *accept, *spoken, "--json", "--out", "bent")
    return PageCall((command,), (_job(body) if bender else {}) | {path: data})


def number_of(body: Mapping[str, Any], key: str, otherwise: float) -> float:
    """Take a number from what the page sends."""
    value = body.get(key, otherwise)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f'"{key}" is {str(value)[:40]!r}; it is a number')
    return float(value)


def flag_of(body: dict[str, Any], key: str) -> bool:
    """Read a key that is true or false; false where it is left out."""
    value = body.get(key, False)
    if not isinstance(value, bool):
        raise InputError(f'"{key}" is {value!r}; it is true or false')
    return value


def _plain(body: dict[str, Any], key: str) -> str:
    """Read a text that becomes an option's value; one that looks like an option itself is refused."""
    value = body[key]
    if not isinstance(value, str) or len(value) > 100 or value.startswith("-") or not value.isprintable():
        raise InputError(f'"{key}" is {str(value)[:40]!r}; it is a short text such as "mm,deg"')
    return value


def _targets(body: dict[str, Any]) -> str:
    """Read the names of targets."""
    names = body.get("targets", ["csv"])
    if names == "all" or not isinstance(names, list) or not all(isinstance(name, str) for name in names) or not names:
        raise InputError(f'"targets" is a list of names out of {", ".join(TARGETS)}')
    return ",".join(target_of(name).name for name in names)


_CALLS: dict[str, Callable[[dict[str, Any]], PageCall]] = {
    "check": _check,
    "design": _design,
    "compare": _compare,
    "limits": _limits,
    "envelope": _envelope,
    "export": _export,
    "recipe": _recipe,
    "audit": _audit,
    "identify": _identify,
    "trace": _trace,
    "bend": _bend,
}

NAMES = tuple(_CALLS)
"""Calls that run commands."""
