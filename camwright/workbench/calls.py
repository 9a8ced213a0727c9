"""What each call of the page asks of the command line."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, target_of
from camwright.workbench.runner import JOB_FILE

LANGUAGES = ("en", "de", "zh")
"""Languages of recipes, and of the page."""

_OUT = ("--out", "out")
_DROPPED = "dropped"


@dataclass(frozen=True)
class Call:
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


def call_of(name: str, body: dict[str, Any]) -> Call:
    """Make the call of a name from what the page sends.

    Raises
    ------
    InputError
        Something that it needs is missing, or not what it should be.
    """
    inputs = {JOB_FILE: job_text(body).encode()}
    return _CALLS[name](body, inputs)


def job_text(body: dict[str, Any]) -> str:
    """Take the job from what the page sends."""
    text = body.get("toml")
    if not isinstance(text, str):
        raise InputError('the body has no "toml", the text of a job file')
    return text


def laws_of(body: dict[str, Any]) -> list[str]:
    """Take the names of baselines to draw from what the page sends."""
    laws = body.get("laws", [])
    if not isinstance(laws, list) or not all(isinstance(law, str) for law in laws):
        raise InputError('"laws" is a list of names of baselines')
    return laws


def _check(_: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    return Call((("check", JOB_FILE, "--json"),), inputs)


def _design(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    figures = () if _flag(body, "figures") else ("--no-figures",)
    return Call((("design", JOB_FILE, "--json", *figures, *_OUT),), inputs)


def _compare(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    objectives = ("--objectives",) if _flag(body, "objectives") else ()
    return Call((("compare", JOB_FILE, "--json", "--no-figures", *objectives),), inputs)


def _limits(_: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    return Call((("limits", JOB_FILE, "--json"),), inputs)


def _envelope(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    points = body.get("points", 9)
    if not isinstance(points, int) or isinstance(points, bool) or not 2 <= points <= 40:
        raise InputError(f'"points" is {points!r}; it is a whole number from 2 to 40')
    return Call((("envelope", JOB_FILE, "--json", "--no-figures", "--points", str(points), *_OUT),), inputs)


def _export(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    design = ("design", JOB_FILE, "--json", "--no-figures", *_OUT)
    units = ("--units", _plain(body, "units")) if body.get("units") else ()
    tables = ("export", "out/design.json", "--to", _targets(body), *units, "--out", "tables", "--json")
    return Call((design, tables), inputs)


def _recipe(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    language = body.get("language", "en")
    if language not in LANGUAGES:
        raise InputError(f'"language" is {language!r}; it is {", ".join(LANGUAGES)}')
    return Call(
        (("recipe", JOB_FILE, "--targets", _targets(body), "--language", language, "--out", "recipe", "--json"),),
        inputs,
    )


def _audit(body: dict[str, Any], inputs: dict[str, bytes]) -> Call:
    """Judge a file that was dropped on the page; its name only tells its ending."""
    name, data = body.get("name"), body.get("base64")
    if not isinstance(name, str) or not isinstance(data, str):
        raise InputError('an audit takes the file\'s "name" and its bytes as "base64"')
    ending = re.search(r"\.[A-Za-z0-9]{1,8}$", name)
    file = _DROPPED + (ending.group() if ending else "")
    try:
        inputs[file] = base64.b64decode(data, validate=True)
    except binascii.Error as error:
        raise InputError('"base64" is no base64') from error
    units = ("--units", _plain(body, "units")) if body.get("units") else ()
    return Call((("audit", file, "--job", JOB_FILE, "--json", "--no-figures", *units),), inputs)


def _flag(body: dict[str, Any], key: str) -> bool:
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


_CALLS: dict[str, Callable[[dict[str, Any], dict[str, bytes]], Call]] = {
    "check": _check,
    "design": _design,
    "compare": _compare,
    "limits": _limits,
    "envelope": _envelope,
    "export": _export,
    "recipe": _recipe,
    "audit": _audit,
}

NAMES = tuple(_CALLS)
"""Calls that run commands."""
