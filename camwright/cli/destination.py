"""`Destination`: where the files of a command go."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from camwright.house.files import fill
from camwright.house.output import complain
from camwright.house.owned import Work, owned
from camwright.house.picture_files import write_pictures
from camwright.house.pictures import Picture
from camwright.jobs.job import Job


@dataclass(frozen=True)
class Destination:
    """Where the files of a command go, and what they are made of."""

    directory: Path
    work: Work

    def write(self, texts: Mapping[str, str | bytes], pictures: Mapping[str, Picture]) -> list[Path]:
        """Write texts and pictures by their names, all or none; gives the paths of the files, sorted."""
        with owned(self.directory, self.work, complain) as aside:
            return self.fill(aside, texts, pictures)

    def fill(self, aside: Path, texts: Mapping[str, str | bytes], pictures: Mapping[str, Picture]) -> list[Path]:
        """Write texts and pictures into a folder aside; gives the paths that all its files will have, sorted."""
        fill(aside, texts)
        if pictures:
            write_pictures(pictures, aside)
        return [self.directory / name for name in sorted(file.name for file in aside.iterdir())]

    def draw(self, pictures: Mapping[str, Picture]) -> list[Path]:
        """Write pictures alone; gives the paths of the files, of each picture its SVG first."""
        with owned(self.directory, self.work, complain) as aside:
            return [self.directory / file.name for file in write_pictures(pictures, aside)]


def destination(command: str, job: Job, file: Path | None, out: Path | None, kind: str = "") -> Destination:
    """Say where a command's files of a job go; where the user names no folder, another job of this name is told by its file."""
    work = Work(command, job.name, job.sha256, file if out is None else None)
    return Destination(Path("out") / f"{job.name}{kind}" if out is None else out, work)
