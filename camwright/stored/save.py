"""Saving a design: design.json and cam.csv, both or neither."""

from __future__ import annotations

import warnings
from pathlib import Path

from camwright.house.owned import Work, write_owned
from camwright.stored.design_text import design_text
from camwright.stored.profile_files import cam_text
from camwright.studies.design import Design


def design_files(design: Design) -> dict[str, str]:
    """Give the texts of a design's files by name.

    Raises
    ------
    InputError
        The job asks for fewer points than the profile has ends of pieces.
    """
    return {"design.json": design_text(design), "cam.csv": cam_text(design)}


def _warn(note: str) -> None:
    warnings.warn(note, UserWarning, stacklevel=5)


def save(design: Design, directory: str | Path) -> tuple[Path, ...]:
    """Save a design as design.json, which `read_design` reads, and cam.csv.

    Parameters
    ----------
    directory
        Where the files shall stand; made if it is missing.

    Returns
    -------
    tuple
        The files.

    Raises
    ------
    InputError
        A file cannot be written; then none is.

    Warns
    -----
    UserWarning
        What was replaced was not of this job, or was changed since.

    Examples
    --------
    >>> import tempfile
    >>> from camwright import load_job, optimise, read_design, save
    >>> result = optimise(load_job())
    >>> files = save(result, tempfile.mkdtemp())
    >>> [file.name for file in files], read_design(files[0]).job == result.job
    (['design.json', 'cam.csv'], True)
    """
    work = Work("design", design.job.name, design.job.sha256)
    return tuple(write_owned(Path(directory), work, design_files(design), _warn))
