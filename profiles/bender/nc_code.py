"""NC programs as text: written as S4 shows it (``fagor``) or as ISO code (``iso``), and read back."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from camwright.profiles.bender.program import FULL_TURN, IntArray, NcProgram
from camwright.profiles.errors import InputError

Flavour = Literal["fagor", "iso"]

_MOST_FAULTS = 20


@dataclass(frozen=True)
class Numbering:
    """Line numbers of the motion lines.

    Parameters
    ----------
    first
        Number of the first motion line; the header's lines have the numbers before it.
    last
        Greatest number that the control takes; the line after it has the number ``first`` again.
    """

    first: int = 10
    last: int = 9999

    def __post_init__(self) -> None:
        if not (len(_HEADER["fagor"]) < self.first <= self.last <= 99_999_999):
            raise InputError(
                f"line numbers from {self.first} to {self.last}: the first must be {len(_HEADER['fagor']) + 1} or "
                "greater, so that the "
                "header has room, and not exceed the last, which must not exceed 99999999"
            )

    def numbers(self, blocks: int) -> IntArray:
        """Return the numbers of the motion lines, with roll-over."""
        return np.asarray(self.first + np.arange(blocks) % (self.last - self.first + 1), dtype=np.int64)


# Millimetres; exact stop, so that no feed is cut short or run over at a corner; feed per minute.
_HEADER: dict[Flavour, tuple[str, ...]] = {"fagor": ("G71", "G07", "G94"), "iso": ("G21", "G61", "G94")}


def write_program(program: NcProgram, flavour: Flavour, numbering: Numbering, speed: float, command: str = "") -> str:
    """Write a program as text.

    Parameters
    ----------
    flavour
        ``"fagor"`` or ``"iso"``.
    numbering
        Numbers of the motion lines.
    speed
        The F word: feed in mm/min, and in degrees per minute for the mould.
    command
        The machine's command that cuts a bridge, such as ``"M20"``.
    """
    lines = [f"%{program.name}"] if flavour == "fagor" else ["%", f"({program.name})"]
    head = [*_HEADER[flavour][:-1], f"{_HEADER[flavour][-1]} F{speed:.3f}"]
    lines += [f"N{i + 1:03d} {words}" for i, words in enumerate(head)]
    numbers = numbering.numbers(program.blocks + 1)
    at = program.bend_blocks()
    feeds, bends = np.divmod(program.feeds, 1000), np.divmod(program.bends % FULL_TURN, 1000)  # right: 360° - beta
    columns = (numbers[at - 1], feeds[0][:-1], feeds[1][:-1], numbers[at], *bends, numbers[at + 1])
    bent = "N%03d G01 G90 Y%d.%03d\nN%03d G01 G90 " + ("Y0.0" if flavour == "fagor" else "Y0.000")
    fed_and_bent = f"{_FED}\n{bent}"
    split = program.split_feeds()
    begins = np.concatenate([[0], at + 2])
    for k, row in enumerate(zip(*(column.tolist() for column in columns), strict=True)):
        if k in split:
            lines += [*_fed_and_cut(split[k], numbers[begins[k] :][: 2 * len(split[k])], command), bent % row[3:]]
        else:
            lines.append(fed_and_bent % row if row[1] or row[2] else bent % row[3:])
    if len(at) in split:
        lines += _fed_and_cut(split[len(at)], numbers[begins[-1] :][: 2 * len(split[len(at)])], command)
    elif program.feeds[-1]:
        lines.append(_FED % (numbers[-2], feeds[0][-1], feeds[1][-1]))
    lines.append(f"N{numbers[-1]:03d} M30")
    if flavour == "iso":
        lines.append("%")
    return "\n".join(lines) + "\n"


def _fed_and_cut(parts: list[int], numbers: IntArray, command: str) -> list[str]:
    """Write a feed that is stopped for cuts."""
    texts = []
    for i, part in enumerate(parts):
        texts += [command] if i else []
        texts += [f"G01 G91 X{part // 1000}.{part % 1000:03d}"] if part else []
    return [f"N{number:03d} {text}" for number, text in zip(numbers.tolist(), texts, strict=False)]


_FED = "N%03d G01 G91 X%d.%03d"
_ANGLE = "G90 Y"
_MOTION = re.compile(r"N\d{3,8} G01 (G91 X|G90 Y)(-?)(\d{1,9})\.(\d{1,3})")
_END = re.compile(r"N\d{3,8} M30")
_CUT = re.compile(r"^N\d{3,8} ")
_HEAD = re.compile(r"N\d{3,8}(?: (?:G71|G21|G07|G61|G94|F\d+\.\d{3}))+")


def read_program(text: str, place: str = "program", command: str | None = None) -> NcProgram:
    """Read a program of either flavour back; lines of the machine's cut command are its cuts.

    Raises
    ------
    InputError
        A line that is none of: header, feed, bend, return, end; or a bend without a return. Each is named with its
        line.
    """
    read = _Read(command)
    faults: list[str] = []
    for row, line in enumerate(text.splitlines(), start=1):
        found = None if read.ended else _MOTION.fullmatch(line)
        fault = read.words(line) if found is None else read.motion(line, *found.groups())
        if fault:
            faults.append(f"{place}, line {row}: {fault}")
        if len(faults) == _MOST_FAULTS:
            break
    if not faults and not read.ended:
        faults.append(f"{place}: the program has no end (M30)")
    if faults:
        raise InputError(*faults)
    feeds = np.array([*read.of.feeds, read.fed], dtype=np.int64)
    return NcProgram(read.name, feeds, np.array(read.of.bends, dtype=np.int64), np.array(read.of.cuts, dtype=np.int64))


@dataclass(frozen=True)
class _Parts:
    """Feeds before each bend (µm), bends, and what was fed from the start at each cut (µm)."""

    feeds: list[int] = field(default_factory=list)
    bends: list[int] = field(default_factory=list)
    cuts: list[int] = field(default_factory=list)


@dataclass
class _Read:
    """What has been read of a program; each line answers with its fault, if it has one."""

    command: str | None
    name: str = ""
    of: _Parts = field(default_factory=_Parts)
    fed: int = 0
    """Fed since the last bend (µm)."""
    bent: bool = False
    """Whether the mould has not returned yet."""
    ended: bool = False

    def words(self, line: str) -> str | None:
        """Read a line without motion: a name, words of the head, the end."""
        if line.startswith(("%", "(")):
            self.name = self.name or line.strip("%()")
        elif self.ended:
            return f"{line[:60]!r} stands after the end of the program"
        elif self.command is not None and not self.bent and _CUT.sub("", line) == self.command:
            self.of.cuts.append(sum(self.of.feeds) + self.fed)
        elif not (_END.fullmatch(line) or _HEAD.fullmatch(line)):
            return f"{line[:60]!r} is not a header, feed, bend, return or end line"
        elif self.bent:
            self.bent = False
            return _no_return(line)
        else:
            self.ended = _END.fullmatch(line) is not None
        return None

    def motion(self, line: str, word: str, sign: str, whole: str, part: str) -> str | None:
        """Read a feed, a bend or a return."""
        value = int(f"{sign}{whole}{part:0<3}")
        if self.bent:
            self.bent = False
            return _no_return(line) if value or word != _ANGLE else None
        if word == _ANGLE:
            if not 0 < value < FULL_TURN or value == FULL_TURN // 2:
                return f"mould angle {value / 1e3:.3f}°; a bend lies between 0 and 360°, not at 180°"
            self.of.feeds.append(self.fed)
            self.of.bends.append(value if value < FULL_TURN // 2 else value - FULL_TURN)
            self.fed, self.bent = 0, True
            return None
        self.fed += value
        return f"feed {value / 1e3:.3f} mm; the rule is fed forwards only" if value <= 0 else None


def _no_return(line: str) -> str:
    return f"the mould must return to zero after a bend; found {line[:60]!r}"
