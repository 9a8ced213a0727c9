"""Where a file comes from: versions and the job's hash; never a time, so that the same job gives the same bytes."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version

SCHEMA_VERSION = 1
"""Version of the layout of design.json; it changes when an older reader would misread the file."""

_LIBRARIES = ("casadi", "numpy", "scipy")


@cache
def camwright_version() -> str:
    """Version of camwright as installed."""
    return version("camwright")


def provenance(job_sha256: str) -> dict[str, str | int | dict[str, str]]:
    """Gather what every file that leaves the house carries.

    Parameters
    ----------
    job_sha256
        SHA-256 of the job file's bytes, in hexadecimal.

    Returns
    -------
    dict
        ``camwright``, ``job_sha256``, ``libraries`` (name and version), ``schema_version``.
    """
    return {
        "camwright": camwright_version(),
        "job_sha256": job_sha256,
        "libraries": dict(_library_versions()),
        "schema_version": SCHEMA_VERSION,
    }


@cache
def _library_versions() -> tuple[tuple[str, str], ...]:
    """Look the libraries' versions up once: each one is a search on the disk."""
    return tuple((name, version(name)) for name in _LIBRARIES)
