"""The example jobs that come with camwright."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from camwright.jobs.job import load_job
from camwright.profiles.errors import InputError

EXAMPLES = Path(__file__).parents[1] / "examples"
"""Where they lie; in a checkout a link to the folder at the top."""


@dataclass(frozen=True)
class Example:
    """An example job.

    Parameters
    ----------
    name
        Its name, that of its file.
    machine
        Kind of its machine.
    about
        What it is about, its file's first comment.
    path
        Its file.
    """

    name: str
    machine: str
    about: str
    path: Path

    @property
    def text(self) -> str:
        """The job file's text."""
        return self.path.read_text(encoding="utf-8")


def examples() -> dict[str, Example]:
    """List the examples by name.

    Examples
    --------
    >>> examples()["flying-saw"].machine
    'linear_carriage'
    """
    found = {}
    for path in sorted(EXAMPLES.glob("*.toml")):
        comment = path.read_text(encoding="utf-8").partition("\nname")[0]
        about = " ".join(line.lstrip("# ") for line in comment.splitlines())
        found[path.stem] = Example(path.stem, load_job(path).machine.kind, about, path)
    return found


def example(name: str) -> Example:
    """Find an example by its name, with or without ``.toml``.

    Raises
    ------
    InputError
        There is none of that name.
    """
    known = examples()
    wanted = name.removesuffix(".toml")
    if wanted not in known:
        raise InputError(f"there is no example {name!r}; the examples are {', '.join(known)}")
    return known[wanted]
