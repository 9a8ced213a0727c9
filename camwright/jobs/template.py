"""A new job file: every key with its meaning, required ones first, optional ones with their defaults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from camwright.house.toml_file import toml_data
from camwright.jobs.keys import JobKey, job_keys, written

_COMMENT_AT = 40
"""Column at which comments begin, where the line leaves room."""


def values_of(text: str) -> dict[str, object]:
    """Read the values of a job file by their places, as they are written: ``{"cut.length": "600 mm"}``."""
    return dict(_flat(toml_data(text, "job", "job file"), ""))


def job_template(values: Mapping[str, object], about: str) -> str:
    """Write a job file with every key that its machine has.

    Parameters
    ----------
    values
        Values by place, as they are written; ``machine.kind`` among them, and whatever is required.
    about
        What the file is, for its first comment.

    Returns
    -------
    str
        The text. Keys that have a value stand with it; others are comments that show their default, or an example.
    """
    lines = [
        f"# {about}",
        "# A key behind a # is optional: its default is shown, or an example where it has none. What a key takes: camwright keys KEY.",
    ]
    tables: dict[str, list[JobKey]] = {}
    for key in job_keys():
        if key.machine in ("", values["machine.kind"]):
            tables.setdefault(key.table, []).append(key)
    for table, keys in tables.items():
        given = any(key.path in values for key in keys)
        if table:
            lines += ["", f"[{table}]" if given or table != "servo.tolerance" else f"# [{table}]"]
        for key in sorted(keys, key=lambda each: not each.required):
            lines.append(_line(key, values))
    return "\n".join(lines) + "\n"


def _line(key: JobKey, values: Mapping[str, object]) -> str:
    """Write a key with its value and meaning."""
    given = key.path in values
    text = f"{key.name} = {written(values[key.path])}" if given else f"# {key.name} = {key.default or key.example}"
    return f"{text:<{_COMMENT_AT - 2}}  # {key.meaning}"


def _flat(data: Mapping[str, object], place: str) -> Iterator[tuple[str, object]]:
    """List the values of nested tables by their places."""
    for key, value in data.items():
        path = f"{place}.{key}" if place else key
        if isinstance(value, dict):
            yield from _flat(value, path)
        else:
            yield path, value
