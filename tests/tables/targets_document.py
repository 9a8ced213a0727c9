"""Makes ``docs/targets.md`` from the registry and files written here: ``python tests/tables/targets_document.py``."""

from __future__ import annotations

import re
from pathlib import Path

from knives import chosen, written

from profiles.tables.target import SAFETY_NOTE
from profiles.tables.targets import TARGETS

DOCUMENT = Path(__file__).parents[2] / "docs" / "targets.md"

_HEAD = f"""# Targets

`camwright export DESIGN --to NAMES` writes a design for drives, `camwright audit FILE --job JOB` reads what they run
today, `camwright targets` lists what is known. No target was tested on a controller: layouts and interpolations come
from the sources named below, and what was inferred is said.

Every file is read back by the target's own reader, the motion is rebuilt as the drive interpolates it, in its number
format, run over three wraps and judged: limits (1 % allowed), sync zone against the sync tolerance, closure, reversal,
servo. A table that fails is not released unless forced, and then says so in its head. All files state the units; angles
are parts of the cycle.

> {SAFETY_NOTE}

The samples are files for a rotary knife: circumference 400 mm, cut length 600 mm, sync zone 200 mm, a jerk-limited
return; master in mm, slave in deg.
"""
_LINES = 30


def document() -> str:
    """Make the whole document."""
    rows = ["| name | controller | points | numbers | points of the sample | position error of the sample (µm) |"]
    rows.append("|---|---|---|---|---|---|")
    sections = []
    for target in TARGETS.values():
        choice, files = chosen(target.name, "jerk-limited"), written(target.name, "jerk-limited")
        most = "no limit documented" if target.max_points is None else f"{target.min_points} to {target.max_points}"
        error = choice.deviation.position * 1e6
        shown = "below 1e-6" if error < 1e-6 else f"{error:.1g}"
        rows.append(
            f"| [`{target.name}`](#{target.name}) | {target.title} | {most} | {target.number_format} "
            f"| {choice.table.points} | {shown} |"
        )
        steps = "\n".join(f"{k}. {step}" for k, step in enumerate(target.steps, start=1))
        sections.append(
            f"## {target.name}\n\n{target.title}. Between the points: {target.interpolation}.\n\n"
            f"Limits: {most} points, numbers in {target.number_format}.\n\nTo bring it in:\n\n{steps}\n\n"
            f"Evidence: {target.evidence}\n\n" + "\n".join(_sample(*item) for item in files.items())
        )
    return _HEAD + "\n" + "\n".join(rows) + "\n\n" + "\n".join(sections)


def _sample(name: str, text: str) -> str:
    lines = [line[:160] + (" …" if len(line) > 160 else "") for line in text.replace("\r\n", "\n").splitlines()]
    if len(lines) > _LINES:
        lines = [*lines[: _LINES - 5], "…", *lines[-4:]]
    return f"`{name}`:\n\n```\n" + "\n".join(re.sub("```", "'''", line) for line in lines) + "\n```\n"


if __name__ == "__main__":
    DOCUMENT.write_text(document(), encoding="utf-8")
