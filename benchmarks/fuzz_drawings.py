"""Fuzzes the bender with damaged drawings: each must be bent or refused, nothing else.

``python benchmarks/fuzz_drawings.py [COUNT]``; 8000 drawings if not given. Ends with exit code 1 at the first drawing that
raises anything but a refusal, takes too long or too much memory, and prints how to make it again.
"""

from __future__ import annotations

import collections
import io
import random
import resource
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path

import ezdxf

from camwright.bender.drawing import Reading, read_drawing
from camwright.bender.dxf_styles import StyleChoice
from camwright.bender.job import load_bender
from camwright.bender.program_file import bend_outlines
from camwright.profiles.errors import InputError

LONGEST = 3.0
"""Processor time that one drawing may take (s)."""

MOST_MEMORY = 300_000
"""What the process may grow to (kB)."""

_LINE = (
    "0 -1 1 2 7 256 0.0 -0.0 1e300 -1e300 1e-300 1e9 nan inf -inf 1,5 99999999999999999999 2147483648 x ff FFFF 2F 1.0 2.0 3.7 "
    "LINE ARC INSERT SEQEND ENDSEC SECTION EOF ENDBLK VERTEX SPLINE BYLAYER $INSUNITS PART"
)
VALUES = [*_LINE.split(" "), "", "é\ud800", "\x00", " " * 300, "9" * 4000]
_CODES = "0 8 10 11 20 40 42 60 62 66 70 71 90 210 230"


def drawing(version: str) -> tuple[str, bytes]:
    """Draw a small drawing with all that the bender reads, as text and as a binary file."""
    document = ezdxf.new(version, units=4)
    space = document.modelspace()
    document.layers.add("CUT", color=1)
    document.layers.add("CREASE", color=3)
    document.layers.add("OLD").freeze()
    part = document.blocks.new("PART")
    part.add_lwpolyline(
        [(0, 0, 0), (40, 0, 0.4), (40, 30, 0), (0, 30, 0)], format="xyb", close=True
    ) if version > "R12" else None
    part.add_line((0, 40), (40, 40))
    part.add_arc((20, 50), 10, 0, 180)
    for k in range(3):
        space.add_blockref("PART", (60 * k, 0), dxfattribs={"layer": ("CUT", "CREASE", "OLD")[k], "rotation": 15 * k})
    space.add_blockref(
        "PART", (0, 200), dxfattribs={"column_count": 3, "row_count": 2, "column_spacing": 50, "row_spacing": 70}
    )
    space.add_polyline2d([(0, 100, 0.2), (50, 100, 0), (50, 130, 0)], format="xyb")
    space.add_circle((200, 100), 12)
    if version > "R12":
        space.add_spline([(0, 150), (20, 160), (40, 140), (60, 150)])
        space.add_ellipse((300, 0), (30, 0), 0.5)
    space.add_text("note")
    text, binary = io.StringIO(), io.BytesIO()
    document.write(text)
    document.write(binary, fmt="bin")
    return text.getvalue(), binary.getvalue()


def damaged_text(text: str, dice: random.Random) -> bytes:
    """Damage the tags of a text file in one to eight places, mostly where the entities are."""
    lines = text.split("\n")
    for _ in range(dice.randrange(1, 9)):
        low = text.count("\n", 0, text.find("BLOCKS")) if dice.random() < 0.8 else 0
        at = min(dice.randrange(low, max(low + 1, len(lines))), len(lines) - 1)
        kind = dice.randrange(7)
        if kind <= 2:
            lines[at] = dice.choice(VALUES)
        elif kind == 3:
            del lines[at : at + dice.choice((1, 2, 2, 4, 40))]
        elif kind == 4:
            lines[at:at] = lines[at : at + dice.choice((1, 2, 20, 400))] * dice.choice((1, 2, 30))
        elif kind == 5:
            lines[at:at] = [dice.choice(_CODES.split(" ")), dice.choice(VALUES)]
        else:
            other = dice.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        if not lines:
            lines = [""]
    data = "\n".join(lines).encode("utf-8", "surrogatepass")
    return data[: dice.randrange(len(data))] if dice.random() < 0.05 and data else data


def damaged_bytes(data: bytes, dice: random.Random) -> bytes:
    """Damage a file byte by byte, or cut it off."""
    for _ in range(dice.randrange(1, 9)):
        at = dice.randrange(len(data))
        kind = dice.randrange(3)
        new = dice.randbytes(dice.randrange(1, 9)) if kind else b""
        data = data[:at] + new + data[at + (len(new) if kind == 1 else dice.choice((0, 1, 8))) :]
    return data[: dice.randrange(len(data))] if dice.random() < 0.1 else data


def main() -> int:
    """Fuzz, and print the counts."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 8000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    sources = [drawing(version) for version in ("R12", "R2000", "R2010")]
    job = load_bender()
    reading = Reading(
        job.drawing.gap, job.drawing.flattening, "mm", style=StyleChoice(each=True), arc_error=job.divide.allowed
    )
    counts: collections.Counter[str] = collections.Counter()
    slowest = 0.0
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "damaged.dxf"
        for number in range(first, first + count):
            dice = random.Random(number)  # noqa: S311 - the number makes the same file again
            text, binary = dice.choice(sources)
            path.write_bytes(
                damaged_bytes(binary, dice)
                if dice.random() < 0.2
                else damaged_bytes(text.encode(), dice)
                if dice.random() < 0.2
                else damaged_text(text, dice)
            )
            begin = time.process_time()
            try:
                bend_outlines(read_drawing(path, reading).outlines, job, "damaged")
                counts["bent"] += 1
            except InputError as error:
                counts["refused"] += 1
                if not str(error) or len(str(error)) > 20_000:
                    print(f"drawing {number}: a refusal without reason or end: {str(error)[:200]!r}")
                    return 1
            except Exception:  # noqa: BLE001 - whatever else it is, it is what is looked for
                traceback.print_exc()
                print(f"drawing {number} raised")
                return 1
            took = time.process_time() - begin
            slowest = max(slowest, took)
            size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            if took > LONGEST or size > MOST_MEMORY:
                print(f"drawing {number} took {took:.2f} s, the process {size} kB")
                return 1
    print(f"{count} drawings: {dict(counts)}; the slowest took {slowest:.3f} s, the process {size} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
